// SPDX-License-Identifier: Apache-2.0
#include "io_node/input_shape.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/support/nightly.h"

namespace slew::io_node {
namespace input_shape_test {

ShapedStep held(double raw, double dead_zone, double most, double start) {
  return shape_step(SignalCourse{{1, raw, raw}}, dead_zone, most, start);
}

TEST(InputShape, AValueThatDoesNotChangeIsPassedOnBitForBit) {
  for (const double raw : {0.1, -0.3, 1.0, 0.7, -1.0, 1.0 / 3}) {
    for (const double most : {kAnyChange, 0.002}) {
      const ShapedStep step =
          shape_step(SignalCourse{{0.3, raw, raw}, {0.1, raw, raw}, {0.6, raw, raw}}, 0.05, most, raw);
      EXPECT_EQ(step.raw_mean, raw);
      EXPECT_EQ(step.mean, raw);
      EXPECT_EQ(step.end, raw);
      EXPECT_EQ(held(raw, 0, kAnyChange, -raw).mean, raw);
    }
  }
}

TEST(InputShape, ARampGivesItsMeanOverTheStep) {
  const ShapedStep rising = held(1, 0, 0.002, 0.5);
  EXPECT_DOUBLE_EQ(rising.mean, 0.501);
  EXPECT_DOUBLE_EQ(rising.end, 0.502);
  const ShapedStep falling = held(-1, 0, 0.002, 0.5);
  EXPECT_DOUBLE_EQ(falling.mean, 0.499);
  EXPECT_DOUBLE_EQ(falling.end, 0.498);
  // after a quarter of the step it has arrived
  const ShapedStep arriving = held(1, 0, 0.002, 0.9995);
  EXPECT_DOUBLE_EQ(arriving.mean, 1 - 0.5 * 0.0005 * 0.25);
  EXPECT_EQ(arriving.end, 1);
}

TEST(InputShape, ASignalSlowerThanTheRampIsNotDelayed) {
  const ShapedStep step = shape_step(SignalCourse{{1, 0.2, 0.2019}}, 0, 0.002, 0.2);
  EXPECT_DOUBLE_EQ(step.mean, 0.20095);
  EXPECT_EQ(step.end, 0.2019);
  // a faster one is left behind
  const ShapedStep slow = shape_step(SignalCourse{{1, 0.2, 0.3}}, 0, 0.002, 0.2);
  EXPECT_DOUBLE_EQ(slow.mean, 0.201);
  EXPECT_DOUBLE_EQ(slow.end, 0.202);
}

TEST(InputShape, TheDeadZoneIsCutWhereTheLineIsInIt) {
  const ShapedStep leaving = shape_step(SignalCourse{{1, 0, 0.4}}, 0.2, kAnyChange, 0);
  EXPECT_DOUBLE_EQ(leaving.raw_mean, 0.2);
  EXPECT_DOUBLE_EQ(leaving.mean, 0.15);
  EXPECT_EQ(leaving.end, 0.4);
  const ShapedStep through = shape_step(SignalCourse{{1, 0.4, -0.3}}, 0.2, kAnyChange, 0.4);
  EXPECT_NEAR(through.mean, (0.2 * 0.3 - 0.1 * 0.25) / 0.7, 1e-15);
  EXPECT_EQ(through.end, -0.3);
}

// the law itself in many small steps
ShapedStep in_small_steps(const SignalCourse& raw, double zone, double most, double r) {
  constexpr int kParts = 20'000;
  ShapedStep result;
  double begun = 0;
  std::size_t piece = 0;
  for (int i = 0; i < kParts; ++i) {
    const double s = (i + 0.5) / kParts;
    while (piece + 1 < raw.size() && s > begun + raw[piece].share) begun += raw[piece++].share;
    const double w = raw[piece].begin + (raw[piece].end - raw[piece].begin) * (s - begun) / raw[piece].share;
    const double wanted = std::fabs(w) < zone ? 0 : w;
    const double before = r;
    r += std::clamp(wanted - r, -most / kParts, most / kParts);
    result.raw_mean += w / kParts;
    result.mean += 0.5 * (before + r) / kParts;
  }
  result.end = r;
  return result;
}

TEST(InputShape, IsTheLawInManySmallSteps) {
  std::mt19937 random(31);
  std::uniform_real_distribution<double> value(-1, 1), part(0.05, 1);
  for (int i = 0; i < testing::rounds(300, 20'000); ++i) {
    SignalCourse raw(1 + random() % 3);
    double sum = 0;
    for (SignalPiece& piece : raw) sum += piece.share = part(random);
    for (SignalPiece& piece : raw) {
      piece.share /= sum;
      piece.begin = value(random);
      piece.end = random() % 3 == 0 ? piece.begin : value(random);
    }
    const double zone = random() % 2 == 0 ? 0.0 : 0.3 * part(random);
    const double most = 5 * part(random), start = value(random);
    const ShapedStep exact = shape_step(raw, zone, most, start), small = in_small_steps(raw, zone, most, start);
    EXPECT_NEAR(exact.raw_mean, small.raw_mean, 5e-4) << i;
    EXPECT_NEAR(exact.mean, small.mean, 5e-4) << i;
    EXPECT_NEAR(exact.end, small.end, 2e-3) << i;
  }
}

}  // namespace input_shape_test
}  // namespace slew::io_node
