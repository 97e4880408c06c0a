// SPDX-License-Identifier: Apache-2.0
// A free body that spins with 1e3 rad/s for 10 s, in every formulation: energy and angular momentum stay, and the
// attitude of a body with two equal moments follows its closed form. Bounds and figures: docs/extremes.md.
#include "tests/support/nightly.h"
#include "tests/validation/multibody/every_formulation.h"
#include "tests/validation/multibody/extremes/outcome.h"

namespace slew::multibody {
namespace spin_test {

using namespace testing;
using math::Vec3;

MechanicsDef spinning(Triple inertia, Triple rate) {
  MechanicsDef def;
  def.gravity = {};
  def.bodies = {{.name = "Rotor", .mass = 1, .inertia = inertia}};
  def.joints = {{.name = "Free", .type = JointType::floating, .body2 = "Rotor", .initial_rotation = rate}};
  return def;
}

class Spin : public EveryFormulation {};

TEST_P(Spin, OfAThousandRadiansASecondKeepsItsInvariantsFor10s) {
  for (const double step : {1e-3, 1e-4}) {
    Formulated rotor = start(spinning({1, 2, 3}, {30, -20, 1e3}));
    const double begin = rotor.total_energy();
    const Vec3 L0(momentum(rotor.model, rotor.ws).angular);
    Outcome outcome;
    for (int i = 0; i < 100; ++i) {
      outcome.is_flagged = !rotor.try_run(0.1, step) || outcome.is_flagged;
      const Vec3 L(momentum(rotor.model, rotor.ws).angular);
      const double error = std::max(std::abs(rotor.total_energy() / begin - 1), norm(L - L0) / norm(L0));
      if (!(error <= outcome.error)) outcome.error = error;
    }
    // one radian a step is more than any rule resolves
    expect_outcome("1e3 rad/s: energy and momentum, relative", setting(step), outcome,
                   is(Formulation::augmented) ? 2e-2 : 1e-3, step == 1e-3 ? Ending::flagged : Ending::right);
  }
}

// R(t) = exp(t L/I~) exp(t Omega e_z~), Omega = (1 - I_z / I) w_z
TEST_P(Spin, OfASymmetricBodyTurnsAsItsClosedForm) {
  constexpr double kAcross = 1, kAlong = 1.7, kStep = 1e-4;
  const double time = slew::testing::rounds(2.0, 10.0);
  const Triple w0 = {50, 0, 1e3};
  Formulated rotor = start(spinning({kAcross, kAcross, kAlong}, w0));
  Outcome outcome;
  outcome.is_flagged = !rotor.try_run(time, kStep);
  const Vec3 L(kAcross * w0[0], 0, kAlong * w0[2]);
  const auto turn = [](Vec3 axis, double angle) {
    const double half = 0.5 * std::remainder(angle, 4 * M_PI);
    const Vec3 v = axis * (std::sin(half) / norm(axis));
    return math::Quaternion{std::cos(half), v[0], v[1], v[2]};
  };
  const math::Quaternion exact =
      turn(L, norm(L) / kAcross * time) * turn({0, 0, 1}, (1 - kAlong / kAcross) * w0[2] * time);
  const std::array<double, 4> found = rotor.pose("Rotor").orientation;
  const double along = found[0] * exact.w + found[1] * exact.x + found[2] * exact.y + found[3] * exact.z;
  outcome.error = 2 * std::acos(std::min(1.0, std::abs(along)));
  expect_outcome("1e3 rad/s: attitude [rad]", setting(kStep), outcome, 0.1, Ending::right);
}

// out of balance by 10 mm: the angle grows evenly, the bearing carries m r w^2 = 1e4 N
TEST_P(Spin, OfAnUnbalancedRotorInItsBearingIsEven) {
  constexpr double kStep = 1e-4, kRate = 1e3, kAside = 0.01;
  const double time = slew::testing::rounds(1.0, 10.0);
  MechanicsDef def;
  def.gravity = {};
  def.bodies = {{.name = "Rotor", .mass = 1, .center_of_mass = {kAside, 0, 0}, .inertia = {0.01, 0.02, 0.025}}};
  def.joints = {{.name = "Bearing", .body2 = "Rotor", .initial_velocity = kRate}};
  Formulated rotor = start(def);
  Outcome outcome;
  outcome.is_flagged = !rotor.try_run(time, kStep);
  outcome.error = std::max(std::abs(rotor.value("Bearing.position") / (kRate * time) - 1), opening(rotor).position);
  expect_outcome("unbalanced rotor of 1e3 rad/s: angle, relative; opening [m]", setting(kStep), outcome, 1e-5,
                 Ending::right);
  std::vector<JointReaction> reactions(1);
  joint_reactions(rotor.model, rotor.state, rotor.ws, {}, reactions);
  outcome.error = std::abs(std::hypot(reactions[0].force[0], reactions[0].force[1]) / (kAside * kRate * kRate) - 1);
  expect_outcome("unbalanced rotor of 1e3 rad/s: bearing force, relative", setting(kStep), outcome, 1e-5,
                 Ending::right);
}

INSTANTIATE_TEST_SUITE_P(In, Spin, kEveryFormulation, kFormulationName);

}  // namespace spin_test
}  // namespace slew::multibody
