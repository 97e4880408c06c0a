// SPDX-License-Identifier: Apache-2.0
#include "multibody/motions/motion_law.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace slew::multibody {
namespace motion_law_test {

MotionDef def_of(MotionShape shape) {
  MotionDef def;
  def.shape = shape;
  if (shape == MotionShape::table) def.points = {{0, 0.5}, {0.4, 1}, {1, -0.2}, {1.5, 0.3}};
  if (shape == MotionShape::speed) def.points = {{0, 0}, {0.4, 2}, {1, -1}};
  def.speed = 0.7;
  def.amplitude = 0.4;
  def.frequency = 1.3;
  def.phase = 0.6;
  def.to = 2;
  def.start = 0.2;
  def.duration = 0.9;
  return def;
}

constexpr MotionShape kShapes[] = {MotionShape::table, MotionShape::harmonic, MotionShape::ramp, MotionShape::speed};

TEST(MotionLaw, HasTheDerivativesOfItsPosition) {
  constexpr double kStep = 1e-5;
  for (const MotionShape shape : kShapes) {
    for (const TableEnds ends : {TableEnds::hold, TableEnds::continued, TableEnds::refused}) {
      MotionDef def = def_of(shape);
      def.ends = ends;
      const MotionLaw law = motion_law(def, 0.5);
      for (const double t : {0.05, 0.3, 0.77, 1.27, 2.5}) {
        const MotionValue here = evaluate(law, t), before = evaluate(law, t - kStep), behind = evaluate(law, t + kStep);
        const double scale = 1 + std::fabs(here.acceleration);
        EXPECT_NEAR((behind.position - before.position) / (2 * kStep), here.speed, 1e-7 * scale);
        EXPECT_NEAR((behind.speed - before.speed) / (2 * kStep), here.acceleration, 1e-7 * scale);
      }
    }
  }
}

TEST(MotionLaw, BeginsInTheStartPositionWhereNothingElseIsGiven) {
  for (const MotionShape shape : {MotionShape::harmonic, MotionShape::ramp, MotionShape::speed}) {
    EXPECT_NEAR(evaluate(motion_law(def_of(shape), 0.123), 0).position, 0.123, 1e-15);
  }
  MotionDef given = def_of(MotionShape::harmonic);
  given.offset = 0;
  EXPECT_NEAR(evaluate(motion_law(given, 0.123), 0).position, 0.4 * std::sin(0.6), 1e-15);
}

TEST(MotionLaw, RampsFromRestToRest) {
  const MotionLaw law = motion_law(def_of(MotionShape::ramp), 1);
  EXPECT_EQ(evaluate(law, 0.1).position, 1);
  EXPECT_EQ(evaluate(law, 0.2).acceleration, 0);
  EXPECT_NEAR(evaluate(law, 0.65).position, 1.5, 1e-15);
  // the largest speed of the quintic is 15/8 of the mean one
  EXPECT_NEAR(evaluate(law, 0.65).speed, 15.0 / 8 / 0.9, 1e-14);
  EXPECT_EQ(evaluate(law, 1.2).position, 2);
  EXPECT_EQ(evaluate(law, 1.2).speed, 0);
}

TEST(MotionLaw, KeepsTheDigitsOfItsPhaseAtFarTimes) {
  const MotionLaw law = motion_law(def_of(MotionShape::harmonic), 0);
  // ten periods are 100/13 s
  const double t = 1e7 * 100 / 13;
  EXPECT_NEAR(evaluate(law, t + 0.2).position, evaluate(law, 0.2).position, 1e-7);
}

TEST(MotionLaw, EndsItsTableAsSet) {
  MotionDef def = def_of(MotionShape::table);
  EXPECT_EQ(evaluate(motion_law(def, 0.5), 9).position, 0.3);
  EXPECT_EQ(evaluate(motion_law(def, 0.5), 9).speed, 0);
  EXPECT_TRUE(holds_at(motion_law(def, 0.5), 9));
  def.ends = TableEnds::continued;
  const MotionLaw continued = motion_law(def, 0.5);
  EXPECT_NE(evaluate(continued, 9).speed, 0);
  EXPECT_EQ(evaluate(continued, 9).speed, evaluate(continued, 2).speed);
  EXPECT_NEAR(evaluate(continued, 1.5 - 1e-9).acceleration, 0, 1e-6);
  def.ends = TableEnds::refused;
  EXPECT_FALSE(holds_at(motion_law(def, 0.5), 1.6));
  EXPECT_TRUE(holds_at(motion_law(def, 0.5), 1.5));
}

}  // namespace motion_law_test
}  // namespace slew::multibody
