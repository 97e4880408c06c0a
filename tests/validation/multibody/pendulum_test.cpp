// SPDX-License-Identifier: Apache-2.0
// Cases A01 (simple pendulum) and A07 (double pendulums), in every formulation.
//
// A01: IFToMM multibody benchmark A01; exact solution by Jacobi elliptic functions. Tolerances of the benchmark:
// position 1e-3 m at 10 s with steps up to 1e-3 s, energy 5e-5 J, constraints 1e-8.
// A07 a: point masses, independent integration good to 1e-11; 1e-3 up to 5 s, energy 1e-6 relative.
// A07 b: Modelica library MultiBody.Examples.Elementary.DoublePendulum (g = 9.80665); 1e-3 up to 3 s.
// Figures: docs/validation/A01_simple_pendulum.md, A07_double_pendulum.md.
#include "tests/validation/multibody/csv_table.h"
#include "tests/validation/multibody/every_formulation.h"

namespace slew::multibody {
namespace pendulum_test {

using namespace testing;

constexpr double kStep = 1e-3;

JointDef hinge(const std::string& name, const std::string& body1, Triple point1, const std::string& body2) {
  return {.name = name, .body1 = body1, .point1 = point1, .body2 = body2};
}

MechanicsDef simple_pendulum() {
  MechanicsDef def;
  def.bodies = {{.name = "Bob", .mass = 1, .center_of_mass = {-1, 0, 0}}};
  def.joints = {hinge("Pivot", "Ground", {}, "Bob")};
  return def;
}

class SimplePendulum : public EveryFormulation {
 protected:
  static void expect(const Figure& figure, double step = kStep) { expect_figure("A01", setting(step), figure); }
};
class DoublePendulum : public EveryFormulation {
 protected:
  static void expect(const Figure& figure, double step = kStep) { expect_figure("A07", setting(step), figure); }
};

TEST_P(SimplePendulum, FollowsTheEllipticFunctions) {
  Formulated pendulum = start(simple_pendulum());
  const double energy = pendulum.total_energy();
  double error = 0, drift = 0, open = 0;
  for (const auto& row : read_table("A01_pendulum.csv")) {
    const Triple bob = pendulum.pose("Bob").center_of_mass;
    error = std::max({error, std::abs(bob[0] - row[1]), std::abs(bob[1] - row[2])});
    drift = std::max(drift, std::abs(pendulum.total_energy() - energy));
    open = std::max(open, opening(pendulum).position);
    if (row[0] < 10 - 1e-9) pendulum.run(0.01, kStep);
  }
  expect({"position, 10 s [m]", error, 1e-3});
  expect({"energy [J]", drift, 5e-5});
  expect({"constraint [m]", open, 1e-8});
  if (is(Formulation::recursive) || is(Formulation::lagrange)) {
    EXPECT_LT(error, 1e-7) << "worse than what fourth order gives";
  }
}

// against the exact end; steps of its own remove the error of a penalty beside that of its step
TEST_P(SimplePendulum, ConvergesWithTheOrderOfItsRule) {
  const auto end_after = [](double h) {
    Formulated pendulum = start(simple_pendulum());
    pendulum.run(10, h);
    return pendulum.pose("Bob").center_of_mass;
  };
  Triple exact = {-0.275087462576117, -0.961419205099125, 0};
  if (is(Formulation::penalty)) exact = end_after(2e-3 / 4);
  const auto error_at = [&](double h) {
    const Triple bob = end_after(h);
    return std::hypot(bob[0] - exact[0], bob[1] - exact[1]);
  };
  const double h = is(Formulation::penalty) ? 0.008 : 0.005;
  const double observed = std::log2(error_at(h) / error_at(h / 2));
  expect({"order missed of " + std::to_string(order()), std::abs(observed - order()), 0.3}, h);
}

TEST_P(SimplePendulum, PullsAtItsPivotWithThreeTimesItsWeight) {
  Formulated pendulum = start(simple_pendulum());
  double largest = 0;
  std::vector<JointReaction> reactions(1);
  for (int i = 0; i < 2500; ++i) {
    pendulum.run(kStep, kStep);
    joint_reactions(pendulum.model, pendulum.state, pendulum.ws, {}, reactions);
    largest = std::max(largest, std::hypot(reactions[0].force[0], reactions[0].force[1]));
  }
  expect({"largest bar force, relative", std::abs(largest / 29.43 - 1), 1e-5});
}

TEST_P(DoublePendulum, OfPointMassesFollowsTheTable) {
  MechanicsDef def;
  def.bodies = {
      {.name = "First", .mass = 1, .center_of_mass = {1, 0, 0}},
      {.name = "Second", .relative_to = "First", .position = {1, 0, 0}, .mass = 1, .center_of_mass = {1, 0, 0}}};
  def.joints = {hinge("Pivot", "Ground", {}, "First"), hinge("Elbow", "First", {1, 0, 0}, "Second")};
  // chaotic from 3 s on: second order needs a tenth of the step
  const double step = is(Formulation::augmented) ? kStep / 10 : kStep;
  Formulated pendulum = start(def);
  const double energy = pendulum.total_energy();
  double error = 0, drift = 0;
  for (const auto& row : read_table("double_pendulum_90_90.csv")) {
    if (row[0] > 5 + 1e-9) break;
    if (row[0] > 0) pendulum.run(0.01, step);
    const double first = pendulum.value("Pivot.position") + M_PI / 2;
    const double second = first + pendulum.value("Elbow.position");
    const Triple tip = pendulum.pose("Second").center_of_mass;
    for (const double difference : {first - row[1], second - row[2], tip[0] - row[5], tip[1] - row[6]}) {
      error = std::max(error, std::abs(difference));
    }
    drift = std::max(drift, std::abs(pendulum.total_energy() - energy));
  }
  expect({"a: angles and tip to 5 s [rad, m]", error, 1e-3}, step);
  // relative to the 2 m of fall that both masses have: 39.24 J
  expect({"a: energy, of 39.24 J", drift / 39.24, 1e-6}, step);
}

TEST_P(DoublePendulum, OfTheModelicaLibraryFollowsTheTable) {
  MechanicsDef def;
  def.gravity = {0, -9.80665, 0};
  const Triple inertia = {13.86 / 12 * 0.0072, 13.86 / 12 * 0.2536, 13.86 / 12 * 0.2536};
  def.bodies = {{.name = "First", .mass = 13.86, .center_of_mass = {0.25, 0, 0}, .inertia = inertia},
                {.name = "Second",
                 .relative_to = "First",
                 .position = {0.5, 0, 0},
                 .mass = 13.86,
                 .center_of_mass = {0.25, 0, 0},
                 .inertia = inertia}};
  def.joints = {hinge("Pivot", "Ground", {}, "First"), hinge("Elbow", "First", {0.5, 0, 0}, "Second")};
  def.rotational_forces = {{.name = "Damper",
                            .body1 = "Ground",
                            .f1 = {1, 0, 0},
                            .g1 = {0, 1, 0},
                            .body2 = "First",
                            .f2 = {1, 0, 0},
                            .damping_constant = 0.1}};
  const double step = is(Formulation::augmented) ? kStep / 4 : kStep;
  Formulated pendulum = start(def);
  double error = 0, published = 0;
  for (const auto& row : read_table("msl_double_pendulum.csv")) {
    if (row[0] > 3 + 1e-9) break;
    if (row[0] > 0) pendulum.run(0.01, step);
    const char* names[] = {"Pivot.position", "Pivot.velocity", "Elbow.position", "Elbow.velocity"};
    for (std::size_t k = 0; k < 4; ++k) {
      error = std::max(error, std::abs(pendulum.value(names[k]) - row[k + 1]));
    }
    if (std::abs(row[0] - 0.3) < 1e-9) {
      published = std::max(std::abs(pendulum.value("Pivot.position") + 0.906582142638),
                           std::abs(pendulum.value("Elbow.position") - 0.734121865736));
    }
  }
  expect({"b: angles and rates to 3 s [rad, rad/s]", error, 1e-3}, step);
  expect({"b: Modelica's own angles at 0.3 s [rad]", published, 2e-6}, step);
}

INSTANTIATE_TEST_SUITE_P(In, SimplePendulum, kEveryFormulation, kFormulationName);
INSTANTIATE_TEST_SUITE_P(In, DoublePendulum, kEveryFormulation, kFormulationName);

}  // namespace pendulum_test
}  // namespace slew::multibody
