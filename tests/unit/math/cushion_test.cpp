// SPDX-License-Identifier: Apache-2.0
#include "math/cushion.h"

#include <gtest/gtest.h>

#include <cmath>

namespace slew::math {
namespace cushion_test {

constexpr double kTransition = 1e4;  // Pa

// 40 mm long, shut over the first 2 mm; K from 1e-7 at the end to 3e-7 at its beginning
CushionDef tapered(bool has_check_valve) {
  return {.length = 0.04,
          .entry = 0.002,
          .area = 5e-3,
          .transition = kTransition,
          .conductances = {{0, 1e-7}, {0.04, 3e-7}},
          .has_check_valve = has_check_valve};
}

TEST(Cushion, DropIsThatOfTheOrificeWithTheDisplacedFlow) {
  const Cushion cushion(tapered(true));
  // 20 mm before the end: K = 2e-7, Q = 1.5e-3 at 0.3 m/s, dp = (Q/K)^2 = 56.25 MPa
  const CushionBrake brake = cushion.at(0.02, 0.3);
  EXPECT_NEAR(brake.drop, 56.25e6, 10);
  EXPECT_NEAR(brake.force, 5e-3 * 56.25e6, 1);
  // near rest linear: dp = sqrt(p_t) Q/K
  EXPECT_NEAR(cushion.at(0.02, 1e-6).drop, 100 * 5e-9 / 2e-7, 1e-3);
  EXPECT_EQ(cushion.at(0.02, 0).drop, 0);
}

// Q of the drop by the orifice's own law, forward
TEST(Cushion, DropFulfilsTheLawOfTheOrificeAtAnySpeed) {
  const Cushion cushion(tapered(true));
  for (double c = 1e-7; c < 3; c *= 2) {
    const double drop = cushion.at(0.03, c).drop;
    const double Q = 2.5e-7 * drop / std::pow(drop * drop + kTransition * kTransition, 0.25);
    EXPECT_NEAR(Q, 5e-3 * c, 1e-12 * Q) << c;
  }
}

TEST(Cushion, BeginsWithoutAStepAndEndsAtItsLength) {
  const Cushion cushion(tapered(true));
  EXPECT_EQ(cushion.at(0.04, 1).force, 0);
  EXPECT_EQ(cushion.at(0.05, 1).force, 0);
  // 1 nm inside, K = 3e-7: linear in w = 5e-7
  EXPECT_NEAR(cushion.at(0.04 - 1e-9, 1).force, 5e-3 * 100 * 5e-7 * 5e-3 / 3e-7, 1e-6);
  // half shut: a quarter of the drop
  const double full = cushion.at(0.0379999, 1).drop, half = cushion.at(0.039, 1).drop;
  EXPECT_NEAR(half / full, 0.25 * std::pow((1e-7 + 0.0379999 * 5e-6) / (1e-7 + 0.039 * 5e-6), 2), 1e-6);
  // pressed into its stop the piston keeps the last area
  EXPECT_EQ(cushion.at(-1e-3, 0.1).force, cushion.at(0, 0.1).force);
}

TEST(Cushion, NeverDrives) {
  for (const bool has_check_valve : {true, false}) {
    const Cushion cushion(tapered(has_check_valve));
    for (double s = -0.001; s < 0.05; s += 0.0007) {
      for (const double c : {-2.0, -0.1, -1e-5, 0.0, 1e-5, 0.1, 2.0}) EXPECT_GE(cushion.at(s, c).force * c, 0);
    }
  }
}

TEST(Cushion, LetsOilInFreelyOrThroughTheThrottle) {
  EXPECT_EQ(Cushion(tapered(true)).at(0.01, -0.2).force, 0);
  const Cushion throttled(tapered(false));
  EXPECT_EQ(throttled.at(0.01, -0.2).force, -throttled.at(0.01, 0.2).force);
}

TEST(Cushion, SlopesAgreeWithDifferences) {
  const Cushion cushion(tapered(false));
  // entry, taper, stop; not at their kinks
  for (const double s : {0.0395, 0.039, 0.03, 0.01, -0.001}) {
    for (const double c : {-1.0, -0.05, -1e-4, 1e-4, 0.05, 1.0}) {
      const CushionBrake brake = cushion.at(s, c);
      const double ds = 1e-8, dc = 1e-6 * std::fabs(c);
      const double by_way = (cushion.at(s + ds, c).force - cushion.at(s - ds, c).force) / (2 * ds);
      const double by_speed = (cushion.at(s, c + dc).force - cushion.at(s, c - dc).force) / (2 * dc);
      EXPECT_NEAR(brake.d_remaining, by_way, 1e-6 * std::fabs(brake.force) / 1e-3 + 1e-9) << s << ' ' << c;
      EXPECT_NEAR(brake.d_closing, by_speed, 1e-6 * std::fabs(brake.d_closing)) << s << ' ' << c;
    }
  }
}

}  // namespace cushion_test
}  // namespace slew::math
