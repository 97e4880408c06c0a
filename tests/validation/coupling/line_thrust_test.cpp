// SPDX-License-Identifier: Apache-2.0
// A cylinder of level tlm beside one of level two on the same body: the circuit moves the piston of the second by the
// forces of both. By the law of the level (docs/models/coupling_levels.md) the line pushes with
//   F_line = S c_m - D v,   S c_m = F + D v_ref,
// at the speed v that the mechanics have reached; v_ref is the circuit's own, which was held over the step before. With
// fixed pressures in the second cylinder and no friction its acceleration is constant over a step,
//   v' = a_free + W_00 F_free + W_01 F_line,
// and its speed and stroke follow without any error of integration.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "tests/support/crane_pair.h"

namespace slew::coupling::test {
namespace line_thrust_test {

using testing::CranePair;

// N, of the free cylinder's pressures on its areas
constexpr double kFree = std::numbers::pi / 4 * (30e5 * 0.1 * 0.1 - 1e5 * (0.1 * 0.1 - 0.05 * 0.05));

// A slide of 4000 kg: `Free` stands along its way, `Line` is inclined and closed.
constexpr const char* kSlide = R"(
session: {duration: 1 s}
mechanics: {gravity: [0, -9.81, 0]}
bodies: {M: {position: [0, 1.6, 0], mass: 4000, inertia: [1, 1, 1]}}
joints:
  R: {type: prismatic, body2: M, point1: [0, 1.6, 0], orientation1: [-90 deg, 0, 0], orientation2: [-90 deg, 0, 0],
      initial_velocity: 0.2}
forces:
  F0: {type: translational, body1: Ground, body2: M}
  F1: {type: translational, body1: Ground, point1: [0.8, 0.2, 0], body2: M}
hydraulics: {start: table13, oil_bulk_modulus: 1.5e9, entrained_air: 0}
templates:
  Cylinder: {type: double_acting_cylinder, piston_diameter: 100 mm, rod_diameter: 50 mm, piston_length: 0,
      chamber_length: 1 m, rod_length: 1.1 m, minimum_stroke: 20 mm, maximum_stroke: 980 mm, cylinder_coefficient: 1,
      bulk_modulus: 1e30}
volumes:
  P: {initial_pressure: 30 bar, fixed: true}
  T: {initial_pressure: 1 bar, fixed: true}
  A: {rigid_volume: 3e-4, initial_pressure: 70 bar}
  B: {rigid_volume: 3e-4, initial_pressure: 20 bar}
components:
  Free: {use: Cylinder, force: F0, port_a: P, port_b: T, coupling: two}
  Line: {use: Cylinder, force: F1, port_a: A, port_b: B, coupling: tlm}
)";

TEST(LineThrust, IsThatOfTheSpeedOfTheMechanics) {
  for (const double H : {0.5e-3, 1e-3, 2e-3}) {
    const scene::Scene scene = scene::load_text(kSlide, "slide", {"session.step=" + std::to_string(1e3 * H) + " ms"});
    CranePair slide(scene);
    slide.start();
    double largest = 0;
    for (int k = 0; k < 200; ++k) {
      const MechanismSample now = slide.mechanics_now.mechanism;
      const ActuatorSample used = slide.hydraulics_now.actuators;
      ASSERT_EQ(used.D[0], 0);
      ASSERT_GT(used.D[1], 0);
      const double wave = used.F[1] + used.D[1] * used.v_ref[1], thrust = wave - used.D[1] * now.v[1];
      const double a = now.a_free[0] + now.W[0] * kFree + now.W[1] * thrust;
      slide.step({});
      const ActuatorSample& moved = slide.hydraulics_now.actuators;
      ASSERT_NEAR(moved.v_ref[0], now.v[0] + H * a, 1e-12) << "step " << k << " of " << H;
      ASSERT_NEAR(moved.x_ref[0], now.x[0] + H * (now.v[0] + H / 2 * a), 1e-12) << "step " << k << " of " << H;
      largest = std::max(largest, std::fabs(H * now.W[1] * used.D[1] * (now.v[1] - used.v_ref[1])));
    }
    EXPECT_GT(largest, 1e-5) << "the speeds of both sides hardly differ";
  }
}

}  // namespace line_thrust_test
}  // namespace slew::coupling::test
