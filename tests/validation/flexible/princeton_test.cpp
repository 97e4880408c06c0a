// SPDX-License-Identifier: Apache-2.0
// B05: the Princeton beam, a slender cantilever under a dead load at its tip that bends it about both axes. Tolerance
// 1 % of the largest of each displacement at the load for segments; linear theory must give its own answer.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/validation/flexible/flexible_def.h"
#include "tests/validation/flexible/segmented_def.h"
#include "tests/validation/multibody/csv_table.h"
#include "tests/validation/multibody/every_formulation.h"

namespace slew::multibody {
namespace princeton_test {

using namespace testing;

constexpr double kLength = 0.508, kChord = 0.0123777, kFlap = 0.0032024;  // m
constexpr double kDegree = std::numbers::pi / 180;

flex::BeamDef beam(double density = 2700) {
  flex::SectionDef section{.shape = flex::SectionShape::solid_rectangle, .width = kChord, .height = kFlap};
  section.shear_factor_y = section.shear_factor_z = 1;
  flex::Material material{.youngs_modulus = 71.7e9, .poisson_ratio = 0.31, .density = density};
  return flex::testing::straight(section, material, {kLength, 0, 0}, 2);
}

// the load turned by theta [deg] from the section's long side
MechanicsDef loaded(double load, double theta) {
  MechanicsDef def;
  def.gravity = {0, 0, 0};
  def.joints = {{.name = "Clamp", .type = JointType::fixed, .body2 = "Beam"}};
  def.point_forces = {{.name = "Load",
                       .body = "Beam.Node2",
                       .direction = {0, std::cos(theta * kDegree), std::sin(theta * kDegree)},
                       .axes = LoadAxes::ground,
                       .force = load}};
  return def;
}

MechanicsDef in_segments(double load, double theta, int segments) {
  MechanicsDef def = loaded(load, theta);
  def.bodies = {{.name = "Beam", .type = BodyType::segmented}};
  def.segmented_bodies = {{.body = "Beam", .chain = slew::testing::segments_of(beam(), segments)}};
  def.integrator = Integrator::trapezoidal;
  return def;
}

// modes rest under gravity: the load as a weight at the tip of a beam without one
MechanicsDef in_modes(double load, double theta) {
  constexpr double kGravity = 9.81, kWithoutWeight = 1e-3;
  MechanicsDef def = loaded(load, theta);
  for (double& g : def.point_forces[0].direction) g *= kGravity;
  def.gravity = def.point_forces[0].direction;
  def.point_forces.clear();
  def.bodies = {{.name = "Beam", .type = BodyType::flexible},
                {.name = "Weight",
                 .relative_to = "Beam",
                 .position = {kLength, 0, 0},
                 .mass = load / kGravity,
                 .inertia = {1e-6, 1e-6, 1e-6}}};
  def.joints.push_back({.name = "Hook", .type = JointType::fixed, .body1 = "Beam.Node2", .body2 = "Weight"});
  def.flexible_bodies = {
      {.body = "Beam", .modes = slew::testing::modes_of(beam(kWithoutWeight), flex::testing::with_modes(0), {})}};
  def.integrator = Integrator::trapezoidal;
  return def;
}

struct Tip {
  Triple shift{};    // m: along, chord, flap
  double twist = 0;  // deg, atan2(R32, R22)
};

Tip tip_of(const Mechanism& mechanism) {
  Tip tip;
  for (std::size_t k = 0; k < 3; ++k) {
    tip.shift[k] = mechanism.value(std::string("Beam.deflection.") + "xyz"[k]);
  }
  const auto [w, x, y, z] = mechanism.pose("Beam.Node2").orientation;
  const math::Mat3 R = math::rotation_of({w, x, y, z});
  tip.twist = std::atan2(R(2, 1), R(1, 1)) / kDegree;
  return tip;
}

// largest error over the angles of one load, of the largest displacement and the largest twist of that load
struct Errors {
  double along = 0, chord = 0, flap = 0, twist = 0;
};

Errors errors_of(double load, int segments) {
  Errors error, size;
  for (const auto& row : read_table("princeton.csv")) {
    if (row[0] != load) continue;
    const Tip tip = tip_of(Mechanism(in_segments(load, row[1], segments)));
    const auto see = [](double& worst, double& largest, double found, double reference) {
      worst = std::max(worst, std::fabs(found - reference));
      largest = std::max(largest, std::fabs(reference));
    };
    see(error.along, size.along, tip.shift[0], row[2]);
    see(error.chord, size.chord, tip.shift[1], row[3]);
    see(error.flap, size.flap, tip.shift[2], row[4]);
    see(error.twist, size.twist, tip.twist, row[5]);
  }
  return {error.along / size.along, error.chord / size.chord, error.flap / size.flap, error.twist / size.twist};
}

TEST(PrincetonBeam, TwentySegmentsBendAndTwistAsTheExactRod) {
  for (const double load : {4.448, 8.896, 13.345}) {
    for (const int segments : {5, 10, 20, 40}) {
      const Errors e = errors_of(load, segments);
      if (std::getenv("SLEWRING_FIGURES") != nullptr) {
        std::printf("| %g | %d | %.2e | %.2e | %.2e | %.2e |\n", load, segments, e.along, e.chord, e.flap, e.twist);
      }
      if (segments < 20) continue;
      EXPECT_LT(e.along, 0.01) << load << " N, " << segments;
      EXPECT_LT(e.chord, 0.01) << load << " N, " << segments;
      EXPECT_LT(e.flap, 0.01) << load << " N, " << segments;
      EXPECT_LT(e.twist, 0.01) << load << " N, " << segments;
    }
  }
}

TEST(PrincetonBeam, ErrorsFallWithTheSquareOfTheSegments) {
  const Errors coarse = errors_of(13.345, 10), fine = errors_of(13.345, 20);
  EXPECT_NEAR(coarse.flap / fine.flap, 4, 0.4);
  EXPECT_NEAR(coarse.twist / fine.twist, 4, 0.4);
}

// modes: linear theory, and no twist
TEST(PrincetonBeam, ModesGiveTheLinearAnswer) {
  for (const auto& [load, flap] : {std::pair(4.448, 8.0026e-2), {8.896, 1.60052e-1}, {13.345, 2.4010e-1}}) {
    const Tip edge = tip_of(Mechanism(in_modes(load, 0)));
    for (const double theta : {0.0, 15.0, 30.0, 45.0, 60.0, 75.0, 90.0}) {
      const Mechanism mechanism(in_modes(load, theta));
      const Tip tip = tip_of(mechanism);
      EXPECT_NEAR(tip.shift[2], flap * std::sin(theta * kDegree), 1e-4 * flap) << load << " N, " << theta;
      EXPECT_NEAR(tip.shift[1], edge.shift[1] * std::cos(theta * kDegree), 1e-9 * edge.shift[1]);
      EXPECT_NEAR(tip.shift[0], 0, 1e-9);
      // no twist: the tip's rotation vector has nothing along the beam
      EXPECT_NEAR(mechanism.pose("Beam.Node2").orientation[1], 0, 1e-12) << load << " N, " << theta;
    }
  }
}

}  // namespace princeton_test
}  // namespace slew::multibody
