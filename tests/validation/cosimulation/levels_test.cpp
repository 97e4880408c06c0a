// SPDX-License-Identifier: Apache-2.0
// Case E01 with the coupling levels: two masses, the spring between them an oil column on the other side of the cut.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/support/nightly.h"
#include "tests/validation/cosimulation/split_masses.h"

namespace slew::cosimulation {
namespace levels_test {

constexpr double kTime = 10;       // s
constexpr double kSubstep = 1e-4;  // s, so that errors are the coupling's
constexpr double kLeak = 1;        // 1/s

double error(Scheme scheme, double lambda, double H) {
  SplitMasses split({}, lambda, scheme, H, kSubstep);
  for (int i = 0; i < static_cast<int>(std::lround(kTime / H)); ++i) split.step();
  return (split.state() - exact_with_oil({}, lambda, kTime)).norm();
}

double order(Scheme scheme, double lambda, double H) {
  return std::log2(error(scheme, lambda, 2 * H) / error(scheme, lambda, H));
}

TEST(LevelsOnTheOscillator, TheSplitSystemIsThatOfE01) {
  const State end = exact_with_oil({}, 0, kTime);
  EXPECT_LT((end - exact_map({}, kTime) * kStart).norm(), 1e-8 * kStart.norm());
}

// a spring without leak is exact by its stiffness and its reference point: the remaining error is the sub-steps'
TEST(LevelsOnTheOscillator, AnOilSpringWithoutLeakIsExactAtAnyStep) {
  for (const Scheme scheme : {kLinear, kTwo, kTwoOverStep}) {
    for (const double H : {1e-3, 1e-2, 0.1}) EXPECT_LT(error(scheme, 0, H), 1e-6 * kStart.norm()) << H;
  }
}

TEST(LevelsOnTheOscillator, HeldForcesCreateEnergyOfFirstOrder) {
  EXPECT_NEAR(order(kHold, 0, 2.5e-4), 1, 0.15);
  EXPECT_GT(error(kHold, 0, 1e-3), 0.2 * kStart.norm());
  SplitMasses split({}, 0, kHold, 1e-3, kSubstep);
  for (int i = 0; i < 10000; ++i) split.step();
  EXPECT_GT(energy({}, split.state()), 1.1e4);
}

TEST(LevelsOnTheOscillator, ALeakCostsSecondOrderWhereTheOilHoldsTheSpeed) {
  EXPECT_NEAR(order(kLinear, kLeak, 2e-3), 2, 0.1);
  EXPECT_LT(error(kLinear, kLeak, 1e-3), 1e-4 * kStart.norm());
}

TEST(LevelsOnTheOscillator, LevelTwoIsOfHigherOrderAndMoreExact) {
  EXPECT_GT(order(kTwo, kLeak, 1e-2), 3);
  EXPECT_LT(error(kTwo, kLeak, 1e-2), 0.02 * error(kLinear, kLeak, 1e-2));
  EXPECT_LT(error(kTwoOverStep, kLeak, 1e-2), 0.02 * error(kLinear, kLeak, 1e-2));
}

double growth(const TwoMasses& of, double lambda, Scheme scheme, double H) {
  SplitMasses split(of, lambda, scheme, H, 2e-3);
  double early = 0, late = 0;
  for (int i = 0; i < 200; ++i) {
    split.step();
    double& largest = i < 100 ? early : late;
    largest = std::max(largest, std::sqrt(energy(of, split.state())));
  }
  return std::pow(late / early, 0.01);
}

// the springs to the walls stand behind the port: 31.6 rad/s of k2, so that H = 0.2 s is 6 rad of it
TEST(LevelsOnTheOscillator, LevelTwoOverTheStepHasNoLimit) {
  const bool is_nightly = slew::testing::is_nightly();
  const auto steps = is_nightly ? std::vector{0.02, 0.1, 0.2, 0.5, 1.0, 3.0} : std::vector{0.2, 3.0};
  for (const double lambda : {10.0, 100.0}) {
    for (const double c : is_nightly ? std::vector{0.0, 0.1, 1.0} : std::vector{0.0, 1.0}) {
      for (const double H : steps) {
        EXPECT_LT(growth({.c1 = c, .c2 = c}, lambda, kTwoOverStep, H), 1.0001) << lambda << " " << c << " " << H;
      }
    }
  }
}

TEST(LevelsOnTheOscillator, TheOthersHaveOne) {
  double instant = 0, linear = 0;
  for (const double H : {0.2, 0.3, 0.5, 1.0}) {
    instant = std::max(instant, growth({}, 10, kTwo, H));
    linear = std::max(linear, growth({}, 10, kLinear, H));
  }
  EXPECT_GT(instant, 1.05);
  EXPECT_GT(linear, 1.05);
}

}  // namespace levels_test
}  // namespace slew::cosimulation
