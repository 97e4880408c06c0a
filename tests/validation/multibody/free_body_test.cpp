// SPDX-License-Identifier: Apache-2.0
// Cases A06 (torque-free asymmetric body) and A09 (heavy top), in every formulation.
//
// A06: Jacobi elliptic functions; invariants 1e-6 relative over 20 s, flip time 1e-3 s, attitude 1e-3.
// A09: heavy top of the EXUDYN examples (MATLAB RK4), independent solution; centre 1e-2 m at 0.2 s with 1 ms, 1e-4 m
// with 0.1 ms. The top turns by 0.15 rad in 1 ms.
// Figures: docs/validation/A06_dzhanibekov.md, A09_heavy_top.md.
#include "tests/validation/multibody/csv_table.h"
#include "tests/validation/multibody/every_formulation.h"

namespace slew::multibody {
namespace free_body_test {

using namespace testing;

// angular velocity in body axes
Triple body_rates(const BodyPose& pose) {
  const auto& [w, x, y, z] = pose.orientation;
  const math::Mat3 R = math::rotation_of({w, x, y, z});
  return math::transpose_multiply(R, math::Vec3(pose.angular_velocity)).array();
}

class Dzhanibekov : public EveryFormulation {
 protected:
  static MechanicsDef wing_def() {
    MechanicsDef def;
    def.gravity = {};
    def.bodies = {{.name = "Wing", .mass = 1, .inertia = {1, 2, 3}}};
    def.joints = {{.name = "Free", .type = JointType::floating, .body2 = "Wing", .initial_rotation = {0.01, 5, 0.01}}};
    return def;
  }
  static void expect(const Figure& figure) { expect_figure("A06", setting(step()), figure); }
  // 5e-3 rad a step of 1 ms leave second order 1e-3 rad short after a flip that grows errors tenfold
  static double step() { return is(Formulation::augmented) ? 1e-4 : 1e-3; }
};

TEST_P(Dzhanibekov, FlipsAsInTheEllipticFunctions) {
  Formulated wing = start(wing_def());
  double rate_error = 0, attitude_error = 0, invariant_error = 0;
  for (const auto& row : read_table("dzhanibekov.csv")) {
    if (row[0] > 0) wing.run(0.02, step());
    const BodyPose pose = wing.pose("Wing");
    const Triple w = body_rates(pose);
    for (std::size_t k = 0; k < 3; ++k) rate_error = std::max(rate_error, std::abs(w[k] - row[k + 1]));
    double along = 0;
    for (std::size_t k = 0; k < 4; ++k) along += pose.orientation[k] * row[k + 4];
    for (std::size_t k = 0; k < 4; ++k) {
      attitude_error = std::max(attitude_error, std::abs((along < 0 ? -1 : 1) * pose.orientation[k] - row[k + 4]));
    }
    const double twice_energy = w[0] * w[0] + 2 * w[1] * w[1] + 3 * w[2] * w[2];
    const double square = w[0] * w[0] + 4 * w[1] * w[1] + 9 * w[2] * w[2];
    const Triple L = momentum(wing.model, wing.ws).angular;
    invariant_error = std::max({invariant_error, std::abs(twice_energy / 50.0004 - 1), std::abs(square / 100.001 - 1),
                                std::abs(std::hypot(L[0], L[1], L[2]) / std::sqrt(100.001) - 1)});
  }
  expect({"attitude, 20 s", attitude_error, 1e-3});
  expect({"rates, 20 s [rad/s]", rate_error, 1e-3});
  expect({"2 E, M^2, |L|, relative", invariant_error, 1e-6});
}

TEST_P(Dzhanibekov, ReversesEveryHalfPeriod) {
  Formulated wing = start(wing_def());
  std::vector<double> crossings;
  double before = 5;
  const int steps = static_cast<int>(std::lround(20 / step()));
  for (int i = 1; i <= steps; ++i) {
    wing.run(step(), step());
    const double now = body_rates(wing.pose("Wing"))[1];
    if (now * before < 0) crossings.push_back(step() * (i - now / (now - before)));
    before = now;
  }
  ASSERT_EQ(crossings.size(), 4U);
  double error = 0;
  for (std::size_t k = 1; k < crossings.size(); ++k) {
    error = std::max(error, std::abs(crossings[k] - crossings[k - 1] - 5.02592913815747));
  }
  expect({"half period [s]", error, 1e-3});
  const Triple end = body_rates(wing.pose("Wing")), expected = {0.01571522, 4.9999853, 0.01220612};
  double end_error = 0;
  for (std::size_t k = 0; k < 3; ++k) end_error = std::max(end_error, std::abs(end[k] - expected[k]));
  expect({"rates at 20 s [rad/s]", end_error, 1e-3});
}

class HeavyTop : public EveryFormulation {
 protected:
  static MechanicsDef top_def() {
    MechanicsDef def;
    def.gravity = {0, 0, -9.81};
    def.bodies = {{.name = "Top", .mass = 15, .center_of_mass = {0, 1, 0}, .inertia = {0.234375, 0.46875, 0.234375}}};
    def.joints = {
        {.name = "Tip", .type = JointType::spherical, .body2 = "Top", .initial_rotation = {0, 150, -4.61538}}};
    return def;
  }
  static BodyPose after_200ms(double h) {
    Formulated top = start(top_def());
    EXPECT_NEAR(energy(top.model, top.ws).kinetic, 5435.696790865547, 5435.7e-9);
    top.run(0.2, h);
    return top.pose("Top");
  }
  static double distance(const Triple& a, const Triple& b) { return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]); }
};

// `augmented`, a trapezoid, takes the steps of the case in two sub-steps
TEST_P(HeavyTop, PrecessesAsTheReference) {
  for (const auto& [step, tolerance] : {std::pair{1e-3, 1e-2}, {1e-4, 1e-4}}) {
    const double h = is(Formulation::augmented) ? 0.5 * step : step;
    const double error = distance(after_200ms(h).center_of_mass, {0.60555056, 0.59895768, -0.52398303});
    expect_figure("A09", setting(h), {"centre at 0.2 s [m]", error, tolerance});
  }
}

// five digits: of Runge-Kutta with 0.1 ms, of the trapezoid with less
TEST_P(HeavyTop, HasTheEulerParametersOfMatlab) {
  const double h = is(Formulation::augmented) ? 2e-5 : 1e-4;
  double sum = 0;
  for (const double e : after_200ms(h).orientation) sum += std::abs(e);
  expect_figure("A09", setting(h), {"sum of Euler parameters, MATLAB's", std::abs(sum - 1.78219), 1e-5});
}

TEST_P(HeavyTop, FollowsTheTableFor2s) {
  Formulated top = start(top_def());
  const double begin = top.total_energy();
  double error = 0, drift = 0, time = 0;
  for (const auto& row : read_table("heavy_top.csv")) {
    if (row[0] > time) top.run(row[0] - time, 1e-4);
    time = row[0];
    error = std::max(error, distance(top.pose("Top").center_of_mass, {row[1], row[2], row[3]}));
    drift = std::max(drift, std::abs(top.total_energy() / begin - 1));
  }
  expect_figure("A09", setting(1e-4), {"centre to 2 s [m]", error, 1e-2});
  expect_figure("A09", setting(1e-4), {"energy, relative", drift, 1e-6});
}

INSTANTIATE_TEST_SUITE_P(In, Dzhanibekov, kEveryFormulation, kFormulationName);
INSTANTIATE_TEST_SUITE_P(In, HeavyTop, kEveryFormulation, kFormulationName);

}  // namespace free_body_test
}  // namespace slew::multibody
