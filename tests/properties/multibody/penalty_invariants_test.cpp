// SPDX-License-Identifier: Apache-2.0
// What mechanisms keep under the formulations `augmented` and `penalty`: momentum, energy, stability under stiff
// elements, the motion through positions in which constraints become dependent.
#include <gtest/gtest.h>

#include <cmath>

#include "multibody/constraints/constraint.h"
#include "multibody/formulations/dynamics.h"
#include "tests/properties/multibody/held.h"
#include "tests/properties/multibody/random_tree.h"
#include "tests/support/nightly.h"
#include "tests/validation/multibody/mechanism.h"

namespace slew::multibody {
namespace penalty_invariants_test {

using namespace testing;
using namespace slew::testing;

double size_of(const Triple& t) {
  return std::hypot(t[0], t[1], t[2]);
}

double distance(const Triple& a, const Triple& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

const std::vector<std::uint32_t> kSeeds = seeds({{1, 20}});

// gentle enough for fixed steps of a random mechanism
State gentle(std::uint32_t seed, const Model& model) {
  State state = random_state(seed, model);
  for (double& u : state.u) u *= 0.25;
  return state;
}

double momentum_error(const Mechanism& mechanism, const State& start, Formulation formulation, double h) {
  Held held(mechanism.model, start, formulation);
  observe(held.model, start, held.ws);
  const Momentum before = momentum(held.model, held.ws);
  EXPECT_TRUE(held.run(static_cast<int>(std::lround(0.2 / h)), h));
  observe(held.model, held.joints, held.ws);
  const Momentum after = momentum(held.model, held.ws);
  return distance(before.linear, after.linear) / (1 + size_of(before.linear)) +
         distance(before.angular, after.angular) / (1 + size_of(before.angular));
}

TEST(HeldInvariants, TwoFreeBodiesKeepTheirMomentum) {
  for_each_seed(kSeeds, [](std::uint32_t seed) {
    RandomTree tree =
        random_tree(seed, {.bodies = 2, .with_gravity = false, .lines_to_ground = false, .floating_root = true});
    for (auto& force : tree.def.translational_forces) force.end_spring_constant = force.end_damping_constant = 0;
    const Mechanism mechanism(tree.def);
    const State start = gentle(seed, mechanism.model);
    EXPECT_LT(momentum_error(mechanism, start, Formulation::penalty, 1e-3), 1e-6);
    // of the trapezoidal rule
    const double coarse = momentum_error(mechanism, start, Formulation::augmented, 1e-3);
    const double fine = momentum_error(mechanism, start, Formulation::augmented, 5e-4);
    EXPECT_LT(fine, 1e-4);
    EXPECT_LT(fine, 0.26 * coarse + 1e-10);
  });
}

TEST(HeldInvariants, EnergyIsKeptWithoutDampers) {
  for_each_seed(kSeeds, [](std::uint32_t seed) {
    RandomTree tree = random_tree(seed, {.bodies = 5});
    for (auto& force : tree.def.translational_forces) force.damping_constant = force.end_spring_constant = 0;
    tree.def.rotational_forces.clear();
    const Mechanism mechanism(tree.def);
    const State start = gentle(seed, mechanism.model);
    const auto drift_of = [&](Formulation formulation, double h) {
      Held held(mechanism.model, start, formulation);
      const double before = held.total_energy();
      double scale = std::fabs(before), largest = 0;
      for (int i = 0; i < 20; ++i) {
        EXPECT_TRUE(held.run(static_cast<int>(std::lround(0.02 / h)), h));
        const double e = held.total_energy();
        scale = std::max(scale, energy(held.model, held.ws).kinetic);
        largest = std::max(largest, std::fabs(e - before));
      }
      return largest / scale;
    };
    EXPECT_LT(drift_of(Formulation::penalty, 1e-3), 1e-6);
    const double coarse = drift_of(Formulation::augmented, 1e-3), fine = drift_of(Formulation::augmented, 5e-4);
    EXPECT_LT(fine, 1e-5);
    EXPECT_LT(fine, 0.26 * coarse + 1e-10);
  });
}

// ---- cost -------------------------------------------------------------------------------------------------------

// hinged rods of 1 kg and 0.5 m, stretched out along x
MechanicsDef chain(int rods) {
  MechanicsDef def;
  std::string before = "Ground";
  for (int i = 0; i < rods; ++i) {
    const std::string rod = "Rod" + std::to_string(i);
    const Triple end = {i == 0 ? 0.0 : 0.5, 0, 0};
    def.bodies.push_back({.name = rod,
                          .relative_to = before,
                          .position = end,
                          .mass = 1,
                          .center_of_mass = {0.25, 0, 0},
                          .inertia = {0.001, 1.0 / 48, 1.0 / 48}});
    def.joints.push_back({.name = "Hinge" + std::to_string(i), .body1 = before, .point1 = end, .body2 = rod});
    before = rod;
  }
  return def;
}

TEST(PenaltyCost, OfAChainIsABlockALink) {
  for (const int rods : {10, 100, 300}) {
    const Model model = build_model(chain(rods));
    const PenaltyModel body = build_penalty_model(model, Formulation::augmented);
    EXPECT_EQ(math::BlockLdl(body.pattern).coupling_count(), rods - 1);
  }
}

// ---- stiff elements ---------------------------------------------------------------------------------------------

// 1 kg on a line to Ground along y
MechanicsDef mass_on_a_line(double stiffness, double damping, double stretch) {
  MechanicsDef def;
  def.gravity = {};
  def.bodies = {{.name = "Mass", .position = {0, 1, 0}, .mass = 1, .inertia = {0.1, 0.1, 0.1}}};
  def.joints = {{.name = "Free", .type = JointType::floating, .body2 = "Mass"}};
  def.translational_forces = {{.name = "Line", .body1 = "Mass", .body2 = "Ground"}};
  def.translational_forces[0].spring_constant = stiffness;
  def.translational_forces[0].damping_constant = damping;
  def.translational_forces[0].free_length = 1 - stretch;
  return def;
}

TEST(StiffElements, ASpringOfAHundredRadiansAStepKeepsItsEnergy) {
  const Mechanism mechanism(mass_on_a_line(1e10, 0, 1e-6));
  Held held(mechanism.model, mechanism.state, Formulation::augmented);
  const double before = held.total_energy();
  EXPECT_NEAR(before, 0.5 * 1e10 * 1e-12, 1e-6);
  for (int i = 0; i < 100; ++i) {
    ASSERT_TRUE(held.run(10, 1e-3));
    EXPECT_NEAR(held.total_energy(), before, 1e-4 * before);
  }
}

TEST(StiffElements, ADamperOfAThousandTimesTheStepStopsTheMass) {
  const Mechanism mechanism(mass_on_a_line(0, 1e6, 0));
  State start = mechanism.state;
  start.u[1] = 1;
  Held held(mechanism.model, start, Formulation::augmented);
  double before = held.total_energy();
  // the rule's factor is (1 - 500) / (1 + 500)
  for (int i = 0; i < 100; ++i) {
    ASSERT_TRUE(held.run(1, 1e-3));
    EXPECT_NEAR(held.total_energy(), before * std::pow(499.0 / 501, 2), 1e-6);
    before = held.total_energy();
  }
}

TEST(StiffElements, LightRodsThatPullAMillionTimesTheirMassAreNoStiffness) {
  MechanicsDef def = chain(10);
  def.static_dummies = {{.name = "Tip", .relative_to = "Rod9", .position = {0.5, 0, 0}, .mass = 1e6}};
  // strings of up to 15000 rad/s under tension: a step of 1 ms cannot resolve them, one of 0.02 ms does
  Mechanism recursive(def);
  Held held(recursive.model, recursive.state, Formulation::augmented);
  const double before = held.total_energy();
  recursive.run(1, 2e-5);
  EXPECT_TRUE(held.run(1000, 1e-3));
  EXPECT_NEAR(held.total_energy(), before, 1e-5 * energy(held.model, held.ws).kinetic);
  // where the weight is; the rods between tremble by 1e-4 m
  const auto tip = [](const Model& model, const Workspace& ws) {
    const BodyPose rod = body_pose(model, ws, find_body(model, "Rod9"));
    const auto& [w, x, y, z] = rod.orientation;
    return (math::Vec3(rod.position) + math::rotation_of({w, x, y, z}) * math::Vec3(0.5, 0, 0)).array();
  };
  EXPECT_LT(distance(tip(recursive.model, recursive.ws), tip(held.model, held.ws)), 1e-5);
}

// ---- redundant rows and singular positions ----------------------------------------------------------------------

// Case A02: bars + 1 vertical rods of 1 kg and 1 m on hinges in Ground, couplers between their tips. Each coupler hangs
// on the rod before it; its other end is closed by all five rows of a hinge, of which the plane needs two.
MechanicsDef four_bars(int bars) {
  MechanicsDef def;
  const auto hinge = [&def](std::string name, std::string body1, Triple point1, std::string body2, double speed) {
    def.joints.push_back(
        {.name = std::move(name), .body1 = std::move(body1), .point1 = point1, .body2 = std::move(body2)});
    def.joints.back().initial_velocity = speed;
  };
  for (int i = 0; i <= bars; ++i) {
    const std::string rod = "Rod" + std::to_string(i);
    const Triple foot = {static_cast<double>(i), 0, 0};
    def.bodies.push_back(
        {.name = rod, .position = foot, .mass = 1, .center_of_mass = {0, 0.5, 0}, .inertia = {1.0 / 12, 0, 1.0 / 12}});
    hinge("Foot" + std::to_string(i), "Ground", foot, rod, -1);
  }
  for (int i = 0; i < bars; ++i) {
    const std::string coupler = "Coupler" + std::to_string(i);
    def.bodies.push_back({.name = coupler,
                          .position = {static_cast<double>(i), 1, 0},
                          .mass = 1,
                          .center_of_mass = {0.5, 0, 0},
                          .inertia = {0, 1.0 / 12, 1.0 / 12}});
    hinge("Tip" + std::to_string(i), "Rod" + std::to_string(i), {0, 1, 0}, coupler, 1);
  }
  return def;
}

std::vector<Constraint> closing_hinges(const Model& model, int bars) {
  std::vector<Constraint> hinges;
  const auto link_of = [&model](const std::string& body) {
    return model.bodies[static_cast<std::size_t>(find_body(model, body))].link;
  };
  for (int i = 0; i < bars; ++i) {
    Constraint hinge;
    hinge.link1 = link_of("Coupler" + std::to_string(i));
    hinge.link2 = link_of("Rod" + std::to_string(i + 1));
    hinge.R_L1 = hinge.R_L2 = math::Mat3::identity();
    hinge.p_L1 = {1, 0, 0};
    hinge.p_L2 = {0, 1, 0};
    hinge.rows = rows_of(JointType::revolute, math::Mat3::identity(), math::Vec3());
    hinges.push_back(hinge);
  }
  return hinges;
}

// the tip of the first rod at 10 s on the branch of the parallelogram, after ten passes in which all bars lie flat and
// every coupler could turn another way: one degree of freedom as an equation of its own, good to 1e-11
struct FlatPasses {
  int bars;
  double x, y;
};

class FourBar : public ::testing::TestWithParam<FlatPasses> {};

TEST_P(FourBar, PassesItsFlatPositionsWithRowsToSpare) {
  const Mechanism mechanism(four_bars(GetParam().bars));
  for (const Formulation formulation : {Formulation::augmented, Formulation::penalty}) {
    Held held(mechanism.model, mechanism.state, formulation, closing_hinges(mechanism.model, GetParam().bars));
    const double before = held.total_energy();
    EXPECT_TRUE(held.run(10000, 1e-3));
    EXPECT_NEAR(held.total_energy(), before, 1e-4 * before);
    const BodyPose tip = body_pose(held.model, held.ws, find_body(held.model, "Coupler0"));
    EXPECT_NEAR(tip.position[0], GetParam().x, 1e-3);
    EXPECT_NEAR(tip.position[1], GetParam().y, 1e-3);
    EXPECT_LT(held.position_error, formulation == Formulation::augmented ? 1e-12 : 1e-6);
  }
}

INSTANTIATE_TEST_SUITE_P(Bars, FourBar,
                         ::testing::Values(FlatPasses{1, 0.4783850577587, 0.8781501787924},
                                           FlatPasses{2, 0.328458111539, 0.944518538179}));

}  // namespace penalty_invariants_test
}  // namespace slew::multibody
