// SPDX-License-Identifier: Apache-2.0
// A rod with modes of torsion and of bending in both planes between two hinges of a planar loop: every coordinate out
// of the plane that the modes give has a row of the loop that holds it, however slender the rod is.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/nightly.h"
#include "tests/validation/flexible/strip.h"

namespace slew::multibody {
namespace torsion_loop_test {

using namespace testing;
using math::Vec3;

// lowest two modes a plane of a square rod of 1 m, and its first of torsion
std::shared_ptr<const ModalBody> twisting(double side) {
  const flex::BeamDef rod = flex::testing::straight(flex::testing::square(side), flex::testing::steel(), {1, 0, 0}, 11);
  const auto all = slew::testing::modes_of(rod, flex::testing::with_modes(6), {});
  std::vector<int> kept = bending(*all, 1, 2);
  for (const int k : bending(*all, 2, 2)) kept.push_back(k);
  for (std::size_t k = 0; k < all->modes(); ++k) {
    const ModalNode& tip = all->nodes.back();
    if (std::fabs(tip.turn[k][0]) < 0.9 * norm(tip.turn[k]) || norm(tip.shift[k]) > 1e-6 * norm(tip.turn[k])) continue;
    kept.push_back(static_cast<int>(k) + 1);
    break;
  }
  EXPECT_EQ(kept.size(), 5U);
  return slew::testing::modes_of(rod, flex::testing::with_modes(6), kept);
}

// Crank 0.5, rod 1, follower 0.9, ground 0.8 m; pulled out of its plane as well.
MechanicsDef four_bar(std::shared_ptr<const ModalBody> modes, Formulation formulation) {
  const double theta = 1;
  const Vec3 A(0.5 * std::cos(theta), 0.5 * std::sin(theta), 0), D = Vec3(0.8, 0, 0) - A;
  const double e = norm(D), x = (e * e + 1 - 0.81) / (2 * e), y = std::sqrt(1 - x * x);
  const Vec3 n = D * (1 / e), rod = n * x + Vec3(-n[1], n[0], 0) * y, follower = A + rod - Vec3(0.8, 0, 0);
  MechanicsDef def;
  def.gravity = {0, -7, 7};
  def.bodies = {{.name = "Crank",
                 .orientation = {theta, 0, 0},
                 .mass = 1,
                 .center_of_mass = {0.25, 0, 0},
                 .inertia = {1e-3, 0.03, 0.03}},
                {.name = "Follower",
                 .position = {0.8, 0, 0},
                 .orientation = {std::atan2(follower[1], follower[0]), 0, 0},
                 .mass = 1,
                 .center_of_mass = {0.45, 0, 0},
                 .inertia = {1e-3, 0.08, 0.08}},
                {.name = "Rod",
                 .type = BodyType::flexible,
                 .position = A.array(),
                 .orientation = {std::atan2(rod[1], rod[0]), 0, 0}}};
  def.joints = {{.name = "Pivot", .body2 = "Crank", .initial_velocity = -2},
                {.name = "Foot", .point1 = {0.8, 0, 0}, .body2 = "Follower"},
                {.name = "Crank_Pin", .body1 = "Crank", .point1 = {0.5, 0, 0}, .body2 = "Rod"},
                {.name = "Rod_Pin", .body1 = "Rod", .point1 = {1, 0, 0}, .body2 = "Follower", .point2 = {0.9, 0, 0}}};
  def.flexible_bodies = {{.body = "Rod", .modes = std::move(modes), .relative_damping = {0.01}}};
  def.formulation = formulation;
  def.integrator = formulation == Formulation::augmented ? Integrator::own : Integrator::trapezoidal;
  def.max_substep = 1e-3;
  return def;
}

TEST(TorsionLoop, ClosesInEveryFormulationOnRodsThickAndThin) {
  constexpr double kEnd = 0.05;
  for (const double side : {0.004, 0.008, 0.012, 0.03}) {
    SCOPED_TRACE("side " + std::to_string(side));
    const auto modes = twisting(side);
    Formulated reference(four_bar(modes, Formulation::augmented));
    reference.run(kEnd, 1e-3);
    for (const Formulation formulation : {Formulation::recursive, Formulation::lagrange}) {
      Formulated bar(four_bar(modes, formulation));
      // all three rows out of the plane hold something
      EXPECT_TRUE(bar.model.cuts[0].redundant.empty()) << name_of(formulation);
      bar.run(kEnd, 1e-3);  // every step converges
      EXPECT_LE(opening(bar).position, 1e-9) << name_of(formulation);
      for (const char* variable : {"Pivot.position", "Foot.position", "Rod.deflection.y", "Rod.deflection.z"}) {
        EXPECT_NEAR(bar.value(variable), reference.value(variable), 2e-5) << name_of(formulation) << ": " << variable;
      }
    }
  }
}

// Modes of 5e3 rad/s out of the plane: a stage's matrix with h^2/4 K holds the rows by a hundredth of what the mass
// alone gives them, which looks like a singular position.
TEST(TorsionLoop, ClosesOnATubeThatIsStiffInTheStep) {
  constexpr double kEnd = 0.05;
  const flex::SectionDef section{.shape = flex::SectionShape::tube, .wall = 0.003, .diameter = 0.05};
  const flex::BeamDef tube = flex::testing::straight(section, flex::testing::steel(), {1, 0, 0}, 11);
  const auto modes = slew::testing::modes_of(tube, flex::testing::with_modes(10), {1, 2, 3, 4, 5, 6, 7});
  Formulated reference(four_bar(modes, Formulation::augmented));
  reference.run(kEnd, 1e-3);
  for (const Integrator integrator : {Integrator::trapezoidal, Integrator::generalised_alpha, Integrator::sdirk2}) {
    for (const Formulation formulation : {Formulation::recursive, Formulation::lagrange}) {
      MechanicsDef def = four_bar(modes, formulation);
      def.integrator = integrator;
      Formulated bar(def);
      bar.run(kEnd, 1e-3);  // every step converges
      EXPECT_EQ(bar.dynamics.parts(), 1) << name_of(formulation) << ", " << name_of(integrator);
      EXPECT_LE(opening(bar).position, 1e-9) << name_of(formulation);
      for (const char* variable : {"Pivot.position", "Foot.position", "Rod.deflection.y", "Rod.deflection.z"}) {
        EXPECT_NEAR(bar.value(variable), reference.value(variable), 2e-5) << name_of(formulation) << ": " << variable;
      }
    }
  }
}

// Bodies that shorten as they bend have masses only near their straight shape: positions near the start, where the rows
// of the loop are looked at, bend them little.
MechanicsDef stiffened_loop(const std::vector<int>& kept) {
  const auto rod = [&kept](double length) {
    flex::ReductionDef reduction = flex::testing::with_modes(6);
    reduction.stiffening = flex::GeometricStiffening::straight_beam;
    const flex::BeamDef beam =
        flex::testing::straight(flex::testing::square(0.02), flex::testing::steel(), {length, 0, 0}, 11);
    return slew::testing::modes_of(beam, reduction, kept);
  };
  MechanicsDef def;
  def.gravity = {0, -9.81, 0};
  def.bodies = {{.name = "Crank", .mass = 1, .inertia = {0.01, 0.01, 0.01}},
                {.name = "Coupler",
                 .type = BodyType::flexible,
                 .position = {0.1, 0, 0},
                 .orientation = {std::numbers::pi / 2, 0, 0}},
                {.name = "Rocker", .type = BodyType::flexible, .position = {0.1, 0.6, 0}}};
  def.joints = {{.name = "Pivot", .body2 = "Crank", .initial_velocity = 20},
                {.name = "Pin", .body1 = "Crank", .point1 = {0.1, 0, 0}, .body2 = "Coupler"},
                {.name = "Elbow", .body1 = "Coupler", .point1 = {0.6, 0, 0}, .body2 = "Rocker"},
                {.name = "Foot", .point1 = {0.6, 0.6, 0}, .body2 = "Rocker", .point2 = {0.5, 0, 0}}};
  def.flexible_bodies = {{.body = "Coupler", .modes = rod(0.6)}, {.body = "Rocker", .modes = rod(0.5)}};
  def.formulation = Formulation::recursive;
  def.integrator = Integrator::trapezoidal;
  def.max_substep = 1e-4;
  return def;
}

TEST(StiffenedLoop, OfTwoRodsStaysWhole) {
  const std::vector<int> in_the_plane = {0, 1}, every_row = {0, 1, 2, 3, 4};
  for (const auto& [modes, held] :
       {std::pair(std::vector<int>{1, 10}, in_the_plane), {{1, 2, 3, 4, 5, 6, 7}, every_row}}) {
    SCOPED_TRACE(std::to_string(modes.size()) + " modes");
    Formulated bar(stiffened_loop(modes));
    // those that hold what nothing else holds
    EXPECT_EQ(bar.model.cuts[0].kept, held);
    bar.run(0.05, 1e-3);
    EXPECT_LE(opening(bar).position, 1e-9);
  }
}

}  // namespace torsion_loop_test
}  // namespace slew::multibody
