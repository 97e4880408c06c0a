// SPDX-License-Identifier: Apache-2.0
// Joint friction by bristles: case D01 (stick-slip of Canudas de Wit 1995) on a rail, and what regularised friction
// cannot do: hold.
//
// D01: M = 1 kg, K = 2 N/m whose end moves with 0.1 m/s, sigma_0 1e5, sigma_1 sqrt(1e5), sigma_2 0.4, F_c 1, F_s 1.5,
// v_s 1e-3. Published x(25 s) = 1.9088392; x(10), x(15), x(20) of an independent solution; 1e-3 m, as in the case.
#include <gtest/gtest.h>

#include <cmath>
#include <span>
#include <vector>

#include "support/mechanics_alone.h"
#include "tests/support/nightly.h"

namespace slew::testing {
namespace joint_friction_test {

constexpr const char* kStickSlip = R"(
mechanics: {gravity: [0, 0, 0], max_substep: 0.25 ms}
bodies:
  Mass: {mass: 1 kg, inertia: [1, 1, 1]}
joints:
  Rail:
    {type: prismatic, body2: Mass, orientation1: [0, 90 deg, 0], orientation2: [0, 90 deg, 0], coulomb_friction: 1 N,
     breakaway_ratio: 1.5, friction_speed: 1 mm/s, bristle_stiffness: 1e5 N/m, bristle_damping: 316.2277660168379 Ns/m,
     viscous_friction: 0.4 Ns/m}
forces:
  Spring: {type: translational, body1: Ground, point1: [-10 m, 0, 0], body2: Mass, free_length: 10 m, spring_constant: 2 N/m}
  End: {type: point_force, body: Mass, axes: ground, force_table: [[0 s, 0 N], [30 s, 6 N]]}
session: {step: 1 ms, duration: 25 s}
)";

TEST(BristleFriction, SticksAndSlipsAsPublished) {
  MechanicsAlone m(scene::load_text(kStickSlip, "stick_slip"));
  const std::pair<double, double> expected[] = {
      {10, 0.62758312898}, {15, 0.918279706}, {20, 1.27259641}, {25, 1.908839199}};
  double peak = 0;
  for (const auto& [time, x] : expected) {
    while (static_cast<double>(m.n) * 1e-3 < time - 1e-9) {
      m.step();
      ASSERT_FALSE(m.report.has(StepFlag::not_converged)) << "at step " << m.n;
      peak = std::max(peak, -m.value("Rail.force"));
    }
    EXPECT_NEAR(m.value("Rail.position"), x, 1e-3) << time;
  }
  EXPECT_NEAR(peak, 1.47657, 5e-3);
}

constexpr const char* kFile = "scenes/forces/joint_friction.yaml";

TEST(BristleFriction, HoldsAtRestForAMinuteAndAgainAfterAPull) {
  const std::vector<const char*> formulations = {"recursive", "lagrange"};
  for (const char* formulation : std::span(formulations).first(slew::testing::rounds<std::size_t>(1, 2))) {
    MechanicsAlone m(
        kFile, {std::string("mechanics.formulation=") + formulation, "Pull.force_table=[[60, 0], [61, 40], [62, 0]]"});
    m.run_to(1);
    const double held = m.value("Rail.position");
    // at rest the bristles are bent by the load over their stiffness
    EXPECT_NEAR(m.subsystem.state().bristles[0], 10 * 3.3552 / 4e5, 1e-12);
    EXPECT_NEAR(m.value("Rail.force"), -10 * 3.3552, 1e-6);
    m.run_to(59.9);
    EXPECT_NEAR(m.value("Rail.position"), held, 1e-12);
    m.run_to(70);
    const double after = m.value("Rail.position");
    EXPECT_GT(after, held + 0.01);
    m.run_to(80);
    EXPECT_NEAR(m.value("Rail.position"), after, 1e-12);
  }
}

TEST(BristleFriction, BreaksAwayAboveItsBreakawayForceOnly) {
  // breakaway at 50 N: 1.25 times 40 N; the slope takes 33.552 N
  for (const auto& [pull, slips] : {std::pair{15.9, false}, {16.9, true}}) {
    MechanicsAlone m(kFile, {"Pull.force_table=[[1, 0], [3, " + std::to_string(pull) + "]]"});
    m.run_to(5);
    EXPECT_EQ(m.value("Rail.position") > 0.01, slips) << pull;
  }
}

TEST(BristleFriction, IsPartOfTheStateHashAndOfAReset) {
  MechanicsAlone m(kFile);
  m.run_to(0.5);
  const std::uint64_t before = m.subsystem.state_hash();
  double& z = m.subsystem.mutable_state().bristles[0];
  z = std::nextafter(z, 1);
  EXPECT_NE(m.subsystem.state_hash(), before);
  m.subsystem.reset();
  m.start();
  m.run_to(0.5);
  EXPECT_EQ(m.subsystem.state_hash(), before);
}

// without bristles: the joint creeps at v_c atanh(F/F_c), the law of its card
TEST(RegularisedFriction, Creeps) {
  MechanicsAlone m(kFile, {"Rail.bristle_stiffness=0", "Rail.bristle_damping=0", "Rail.breakaway_ratio=1"});
  m.run_to(1.9);
  EXPECT_NEAR(m.value("Rail.velocity"), 0.01 * std::atanh(33.552 / 40), 1e-5);
}

}  // namespace joint_friction_test
}  // namespace slew::testing
