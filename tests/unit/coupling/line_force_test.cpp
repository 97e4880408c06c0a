// SPDX-License-Identifier: Apache-2.0
#include "coupling/line_force.h"

#include <gtest/gtest.h>

#include <cmath>

namespace slew::coupling {
namespace line_force_test {

LineForceDef crane_lift() {
  LineForceDef def;
  def.friction_curve = {{0, 0}, {1e-4, 1}, {0.025, 0.9}, {0.05, 0.4}, {0.1, 0.2}, {1, 0.8}};
  def.efficiency = 0.9;
  def.seal_friction = 1000;
  def.stroke_min = 0.7;
  def.stroke_max = 1.05;
  def.stop_stiffness = 5e7;
  def.stop_damping = 5e5;
  return def;
}

TEST(LineForce, FrictionOpposesTheMotionWhateverTheSignOfTheForce) {
  const LineForceLaw law(crane_lift());
  for (const double F : {-3e5, -1.0, 0.0, 2e5}) {
    for (const double v : {-2.0, -0.03, -1e-5, 1e-5, 0.03, 2.0}) {
      EXPECT_GE(law.friction(F, v) * v, 0.0) << F << ' ' << v;
    }
  }
  EXPECT_EQ(law.friction(2e5, 0.0), 0.0);
}

TEST(LineForce, FrictionHasTheValuesOfTheCurve) {
  const LineForceLaw law(crane_lift());
  // |F| (1 - eta) f(v) + seal friction, by hand
  EXPECT_NEAR(law.friction(2e5, 0.025), 2e5 * 0.1 * 0.9 + 1000, 1e-9);
  EXPECT_NEAR(law.friction(-2e5, 0.0375), 2e5 * 0.1 * 0.65 + 1000, 1e-9);
  EXPECT_NEAR(law.friction(2e5, 5.0), 2e5 * 0.1 * 0.8 + 1000, 1e-9);  // last value held
}

TEST(LineForce, ViscousFrictionIsProportionalToTheSpeed) {
  const LineForceLaw law(LineForceDef{.friction_curve = {}, .viscous_friction = 1e5});
  for (const double v : {-0.3, 0.0, 0.02}) {
    EXPECT_DOUBLE_EQ(law.friction(5e4, v), 1e5 * v);
    EXPECT_DOUBLE_EQ(law.evaluate(5e4, 0, v).d_speed, -1e5);
  }
}

TEST(LineForce, IsMadeOfTheFrictionAndTheStopThatAreShown) {
  const LineForceLaw law(crane_lift());
  for (const double F : {-1e5, 0.0, 3e5}) {
    for (const double x : {0.69, 0.9, 1.06}) {
      for (const double v : {-0.2, -3e-5, -0.0, 0.0, 4e-5, 0.3}) {
        EXPECT_EQ(law.evaluate(F, x, v).force, F - law.friction(F, v) + law.stop_force(x, v)) << F << ' ' << v;
      }
    }
  }
}

TEST(LineForce, HasNoFrictionAtRestWhateverTheCurve) {
  LineForceDef def = crane_lift();
  def.friction_curve = {{0.001, 1}, {1, 0.8}};
  const LineForceLaw law(def);
  EXPECT_EQ(law.friction(3e5, 0.0), 0);
  EXPECT_EQ(law.evaluate(3e5, 0.9, 0.0).force, 3e5);
}

TEST(LineForce, StopPushesOnlyAndOnlyOutside) {
  const LineForceLaw law(crane_lift());
  EXPECT_EQ(law.stop_force(0.8, 1.0), 0.0);
  EXPECT_NEAR(law.stop_force(0.699, 0.0), 5e4, 1e-6);
  EXPECT_NEAR(law.stop_force(1.051, 0.01), -(5e4 + 5e3), 1e-6);
  // leaving fast, the damper may not pull
  EXPECT_EQ(law.stop_force(0.699, 1.0), 0.0);
  EXPECT_EQ(law.stop_force(1.051, -1.0), 0.0);
}

TEST(LineForce, SlopesAgreeWithDifferences) {
  const LineForceLaw law(crane_lift());
  const double h = 1e-7;
  for (const double F : {-1e5, 3e5}) {
    for (const double x : {0.69, 0.9, 1.06}) {
      for (const double v : {-0.2, -3e-5, 4e-5, 0.03, 0.3}) {
        const LineForce line = law.evaluate(F, x, v);
        const auto force = [&](double dF, double dx, double dv) { return law.evaluate(F + dF, x + dx, v + dv).force; };
        EXPECT_NEAR(line.d_pressure, (force(1, 0, 0) - force(-1, 0, 0)) / 2, 1e-6);
        EXPECT_NEAR(line.d_position, (force(0, h, 0) - force(0, -h, 0)) / (2 * h), 1e-6 * 5e7);
        EXPECT_NEAR(line.d_speed, (force(0, 0, h) - force(0, 0, -h)) / (2 * h), 1e-6 * 3e8);
        EXPECT_NEAR(line.force, F - law.friction(F, v) + law.stop_force(x, v), 1e-9);
      }
    }
  }
}

// Cushions of 40 mm at both ends, of different areas.
LineForceDef cushioned_lift() {
  LineForceDef def = crane_lift();
  def.cushion_min = {
      .length = 0.04, .entry = 0.001, .area = 0.02, .transition = 1e4, .conductances = {{0, 2e-7}, {0.04, 6e-7}}};
  def.cushion_max = {.length = 0.04,
                     .entry = 0.001,
                     .area = 0.01,
                     .transition = 1e4,
                     .conductances = {{0, 3e-7}},
                     .has_check_valve = false};
  return def;
}

TEST(LineForce, CushionBrakesBeforeEachEndAndOnlyThere) {
  const LineForceLaw law(cushioned_lift()), bare(crane_lift());
  EXPECT_FALSE(bare.has_cushion());
  EXPECT_EQ(bare.cushion_force(0.701, -0.1), 0);
  // A dp at half of the ways; dp^2 = q^2/2 (q^2 + (q^4 + 4 p_t^2)^(1/2)), q = A v/K, is q^2 + p_t^2/(2 q^2) for q^2 >>
  // p_t
  const auto brake = [](double A, double K) {
    const double q_2 = std::pow(A * 0.05 / K, 2);
    return A * (q_2 + 1e8 / (2 * q_2));
  };
  EXPECT_NEAR(law.cushion_force(0.72, -0.05), brake(0.02, 4e-7), 1e-3);
  EXPECT_NEAR(law.cushion_force(1.03, 0.05), -brake(0.01, 3e-7), 1e-3);
  EXPECT_EQ(law.cushion_force(0.72, 0.05), 0);
  EXPECT_NEAR(law.cushion_force(1.03, -0.05), brake(0.01, 3e-7), 1e-3);
  for (const double v : {-0.1, 0.1}) EXPECT_EQ(law.cushion_force(0.9, v), 0);
  for (const double x : {0.69, 0.72, 0.9, 1.03, 1.06}) {
    for (const double v : {-0.2, 0.0, 0.2}) {
      const double expected = 2e5 - law.friction(2e5, v) + law.stop_force(x, v) + law.cushion_force(x, v);
      EXPECT_EQ(law.evaluate(2e5, x, v).force, expected);
    }
  }
}

TEST(LineForce, SlopesOfCushionsAgreeWithDifferences) {
  const LineForceLaw law(cushioned_lift());
  const double h = 1e-7;
  for (const double x : {0.705, 0.7396, 0.9, 1.0104, 1.04}) {
    for (const double v : {-0.2, -0.03, -1e-3, 1e-3, 0.03, 0.2}) {
      const LineForce line = law.evaluate(1e5, x, v);
      const auto force = [&](double dx, double dv) { return law.evaluate(1e5, x + dx, v + dv).force; };
      EXPECT_NEAR(line.d_position, (force(h, 0) - force(-h, 0)) / (2 * h), 1e-5 * std::fabs(line.d_position) + 1);
      EXPECT_NEAR(line.d_speed, (force(0, h) - force(0, -h)) / (2 * h), 1e-5 * std::fabs(line.d_speed) + 1);
    }
  }
}

LineForceDef stribeck() {
  LineForceDef def;
  def.seal_friction = 800, def.breakaway_friction = 500, def.stribeck_speed = 0.02, def.seal_speed = 1e-4;
  return def;
}

TEST(SealFriction, FallsFromBreakawayAlongTheStribeckCurveWhateverThePressure) {
  const LineForceLaw law(stribeck());
  for (const double F : {-1e5, 0.0, 4e5}) {
    EXPECT_NEAR(law.friction(F, 1e-3), 800 + 500 * std::exp(-0.0025), 1e-9);
    EXPECT_NEAR(law.friction(F, -0.02), -800 - 500 / std::exp(1.0), 1e-9);
    EXPECT_NEAR(law.friction(F, 0.5), 800, 1e-9);
    EXPECT_EQ(law.friction(F, 0), 0);
    EXPECT_NEAR(law.friction(F, 5e-5), 0.5 * (800 + 500 * std::exp(-6.25e-6)), 1e-9);
  }
}

TEST(SealFriction, SlopesAgreeWithDifferencesAndNeverDrive) {
  const LineForceLaw law(stribeck());
  for (const double v : {-0.3, -0.02, -1e-3, -4e-5, 4e-5, 1e-3, 0.01, 0.05}) {
    const double h = 1e-9, slope = (law.evaluate(1e5, 0, v + h).force - law.evaluate(1e5, 0, v - h).force) / (2 * h);
    EXPECT_NEAR(law.evaluate(1e5, 0, v).d_speed, slope, 1e-5 * std::fabs(slope) + 1) << v;
    EXPECT_GT(law.friction(1e5, v) * v, 0) << v;
  }
}

TEST(LineForce, TimeToRestReachesTheEdgeOfTheSteepPart) {
  const LineForceLaw law(crane_lift());
  const double edge = 1e-4;
  for (const double sign : {-1.0, 1.0}) {
    // just before the edge, on the parabola of speed, acceleration and jerk
    for (const double j : {-500.0, 0.0, 500.0}) {
      const double v = 1e-3, a = -2, t = law.time_to_rest(sign * v, sign * a, sign * j);
      const double there = v + a * t + 0.5 * j * t * t;
      EXPECT_GT(there, edge);
      EXPECT_LT(there, 1.5 * edge);
    }
    // from there to just behind it
    const double t = law.time_to_rest(sign * 1.01 * edge, -sign * 2, 0);
    EXPECT_LT(1.01 * edge - 2 * t, edge);
    EXPECT_GT(1.01 * edge - 2 * t, 0.9 * edge);
  }
}

TEST(LineForce, TimeToRestIsInfiniteWhereRestIsNotReached) {
  const LineForceLaw law(crane_lift());
  EXPECT_TRUE(std::isinf(law.time_to_rest(1e-3, 2, 0)));     // faster
  EXPECT_TRUE(std::isinf(law.time_to_rest(5e-5, -2, 0)));    // inside already
  EXPECT_TRUE(std::isinf(law.time_to_rest(1e-3, -2, 1e4)));  // turns before it
  EXPECT_TRUE(std::isinf(law.time_to_rest(0, 0, 0)));
  LineForceDef smooth = crane_lift();
  smooth.friction_curve.clear();
  smooth.seal_friction = 0;
  EXPECT_TRUE(std::isinf(LineForceLaw(smooth).time_to_rest(1e-3, -2, 0)));
}

}  // namespace line_force_test
}  // namespace slew::coupling
