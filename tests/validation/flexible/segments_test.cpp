// SPDX-License-Identifier: Apache-2.0
// B01 to B03 in finite segments: statics, frequencies, spin-up and pendulum, and how they converge over the segments.
#include <algorithm>
#include <cmath>
#include <vector>

#include "multibody/flexible/segment_speeds.h"
#include "multibody/formulations/passes.h"
#include "tests/support/nightly.h"
#include "tests/validation/flexible/segmented_def.h"
#include "tests/validation/flexible/small_motion.h"
#include "tests/validation/multibody/csv_table.h"
#include "tests/validation/multibody/every_formulation.h"

namespace slew::multibody {
namespace segments_test {

using namespace testing;

void print_row(const char* which, int segments, double figure) {
  if (std::getenv("SLEWRING_FIGURES") != nullptr) std::printf("| %s | %d | %.3e |\n", which, segments, figure);
}

// ---- B01 ----

MechanicsDef cantilever(int segments, double load) {
  MechanicsDef def;
  def.gravity = {0, 0, 0};
  def.bodies = {{.name = "Beam", .type = BodyType::segmented}};
  def.joints = {{.name = "Clamp", .type = JointType::fixed, .body2 = "Beam"}};
  def.point_forces = {{.name = "Load",
                       .body = "Beam",
                       .point = {2, 0, 0},
                       .direction = {0, 1, 0},
                       .axes = LoadAxes::ground,
                       .force = load}};
  def.segmented_bodies = {
      {.body = "Beam", .chain = slew::testing::segments_of(flex::testing::cantilever_b01(4), segments)}};
  def.integrator = Integrator::trapezoidal;
  return def;
}

// a load so small that the deflection is linear in it
TEST(SegmentedCantilever, DeflectsAsTheBeamWithAnyNumber) {
  for (const int segments : {1, 2, 5, 20}) {
    const Mechanism beam(cantilever(segments, 1));
    EXPECT_NEAR(beam.value("Beam.deflection.y"), 1.5267809524e-6, 1e-7 * 1.5267809524e-6) << segments;
    EXPECT_NEAR(beam.value("Beam.largest_deflection"), 1.5267809524e-6, 1e-6 * 1.5267809524e-6) << segments;
    EXPECT_NEAR(beam.value("Beam.strain_energy"), 1.5267809524e-6 / 2, 1e-6 * 1.5267809524e-6) << segments;
  }
}

// Frequencies of small motion about the straight beam [Hz], ascending.
std::vector<double> frequencies(int segments) {
  std::vector<double> hertz;
  for (const double square : squares_of(cantilever(segments, 0))) hertz.push_back(std::sqrt(square) / (2 * M_PI));
  return hertz;
}

// bending comes twice, of a square section; Timoshenko's beam by the transfer matrix, and the first in stretch
TEST(SegmentedCantilever, FrequenciesConvergeWithTheSquareOfTheSegments) {
  const std::pair<std::size_t, double> exact[] = {{0, 20.8463981}, {2, 129.12061735}, {4, 355.02322634}};
  std::vector<double> before(3);
  for (const int segments : {5, 10, 20, 40}) {
    const std::vector<double> found = frequencies(segments);
    for (std::size_t k = 0; k < 3; ++k) {
      const double error = found[exact[k].first] / exact[k].second - 1;
      print_row(("B01, frequency " + std::to_string(k + 1)).c_str(), segments, error);
      if (segments == 20) {
        EXPECT_NEAR(before[k] / error, 4, 0.4) << k;
      }
      before[k] = error;
    }
    const bool has_stretch = std::any_of(found.begin(), found.end(), [&](double f) {
      const double n = segments, chain = 646.5242691 * 4 * n / M_PI * std::sin(M_PI / (4 * n));
      return std::fabs(f / chain - 1) < 1e-6;
    });
    EXPECT_TRUE(has_stretch) << segments;
    EXPECT_NEAR(2 * M_PI * found.back(), fastest_segments(build_model(cantilever(segments, 0))).omega,
                1e-3 * 2 * M_PI * found.back());
  }
}

// ---- B02 ----

constexpr double kSpinUp = 15;

Table hub_angle(double speed) {
  Table table;
  for (int i = 0; i <= 1200; ++i) {
    const double t = i * 0.025, turn = 2 * M_PI / kSpinUp;
    const double angle = t <= kSpinUp ? speed / kSpinUp * (t * t / 2 + (std::cos(turn * t) - 1) / (turn * turn))
                                      : speed * t - speed * kSpinUp / 2;
    table.push_back({t, angle});
  }
  return table;
}

MechanicsDef spinning(double speed, int segments) {
  flex::SectionDef section{.area = 1, .second_moment_y = 5e-4, .second_moment_z = 5e-4, .torsion_constant = 1e-3};
  section.shear_factor_y = section.shear_factor_z = 1;
  flex::Material material{.youngs_modulus = 2.8e7, .poisson_ratio = 0.3, .shear_modulus = 1e7, .density = 1.2};
  MechanicsDef def;
  def.gravity = {0, 0, 0};
  def.bodies = {{.name = "Beam", .type = BodyType::segmented}};
  def.joints = {{.name = "Hub", .body2 = "Beam"}};
  def.motions = {{.name = "SpinUp", .joint = "Hub", .points = hub_angle(speed)}};
  def.segmented_bodies = {
      {.body = "Beam",
       .chain = slew::testing::segments_of(flex::testing::straight(section, material, {10, 0, 0}, 3), segments)}};
  def.integrator = Integrator::trapezoidal;
  return def;
}

struct SpinUpRun {
  double worst = 0, lowest = 0, stretch = 0;  // m
};

SpinUpRun run(double speed, int segments, const char* table) {
  Formulated beam(spinning(speed, segments));
  const double h = 2.5e-3;
  SpinUpRun result;
  double time = 0;
  for (const auto& row : read_table(table)) {
    if (row[0] > time) beam.run(row[0] - time, h);
    time = row[0];
    const math::Vec3 tip = tip_deflection(beam.model, beam.model.segmented[0], beam.ws);
    result.worst = std::max(result.worst, std::fabs(tip.y() - row[2]));
    result.lowest = std::min(result.lowest, tip.y());
    result.stretch = tip.x();
  }
  return result;
}

TEST(SegmentedSpinUp, FollowsTheExactBeam) {
  for (const int segments : slew::testing::is_nightly() ? std::vector{5, 10, 20, 40} : std::vector{20}) {
    const SpinUpRun fast = run(6, segments, "spinup_svq.csv");
    print_row("B02, 6 rad/s: largest error of v over 0.57386 m", segments, fast.worst / 0.57386);
    print_row("B02, 6 rad/s: lowest v [m]", segments, fast.lowest);
    print_row("B02, 6 rad/s: stretch at the end [m]", segments, fast.stretch);
    if (segments < 20) continue;
    EXPECT_LT(fast.worst, 0.01 * 0.57386);
    EXPECT_NEAR(fast.lowest, -0.57386, 0.01 * 0.57386);
    EXPECT_NEAR(fast.stretch, 5.14e-4, 0.02 * 5.14e-4);
  }
}

TEST(SegmentedSpinUp, SlowOneIsNoLinearTheory) {
  const SpinUpRun slow = run(1, 20, "spinup_slow.csv");
  print_row("B02, 1 rad/s: lowest v [m]", 20, slow.lowest);
  EXPECT_LT(slow.worst, 0.01 * 0.10444);
  EXPECT_NEAR(slow.lowest, -0.10444, 0.01 * 0.10444);
}

// ---- B03 ----

class SegmentedPendulum : public EveryFormulation {};

MechanicsDef pendulum(int segments) {
  flex::SectionDef section{.shape = flex::SectionShape::solid_rectangle, .width = 0.01, .height = 0.02};
  section.shear_factor_y = section.shear_factor_z = 5.0 / 6;
  MechanicsDef def;
  def.bodies = {{.name = "Rod", .type = BodyType::segmented}};
  def.joints = {{.name = "Pin", .body2 = "Rod"}};
  def.segmented_bodies = {
      {.body = "Rod",
       .chain = slew::testing::segments_of(
           flex::testing::straight(section, flex::testing::steel(7e10, 2700), {1, 0, 0}, 3), segments),
       .start = SegmentStart::straight}};
  def.static_dummies = {{.name = "Middle", .relative_to = "Rod", .position = {0.5, 0, 0}}};
  def.max_substep = 1e-6;
  return def;
}

TEST_P(SegmentedPendulum, SwingsAndBendsAsTheExactBeam) {
  Formulated rod = start(pendulum(20));
  const double step = 1e-5;
  double time = 0, error = 0, bend = 0, reference = 0;
  for (const auto& row : read_table("flex_pendulum_stiff.csv")) {
    if (row[0] > time) rod.run(row[0] - time, step);
    time = row[0];
    const Triple tip = rod.pose("Rod.Segment21").position, middle = rod.pose("Rod.Node2").position;
    error = std::max({error, std::abs(tip[0] - row[1]), std::abs(tip[1] - row[2])});
    const double length = std::hypot(tip[0], tip[1]);
    bend = std::max(bend, std::abs((tip[0] * middle[1] - tip[1] * middle[0]) / length));
    reference = std::max(reference, std::abs(row[4]));
  }
  EXPECT_LT(error, 1e-3);
  EXPECT_NEAR(bend, reference, 0.05 * reference);
  print_row("B03, tip [m]", 20, error);
  print_row("B03, middle off the chord [m]", 20, bend);
}

INSTANTIATE_TEST_SUITE_P(In, SegmentedPendulum, ::testing::Values(Formulation::recursive), kFormulationName);

}  // namespace segments_test
}  // namespace slew::multibody
