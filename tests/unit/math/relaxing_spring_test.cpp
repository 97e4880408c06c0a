// SPDX-License-Identifier: Apache-2.0
#include "math/relaxing_spring.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <vector>

namespace slew::math {
namespace relaxing_spring_test {

struct Change {
  double end = 0, integral = 0;
};

// of z' = rate - lambda z from z = 0 over H, by 20,000 steps of the trapezoidal rule on a grid that is fine at the
// start
Change change(double rate, double lambda, double H) {
  constexpr int kSteps = 20'000;
  Change result;
  double z = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double from = std::pow(static_cast<double>(i) / kSteps, 4) * H;
    const double h = std::pow(static_cast<double>(i + 1) / kSteps, 4) * H - from;
    const double next = ((1 - h * lambda / 2) * z + h * rate) / (1 + h * lambda / 2);
    result.integral += h / 2 * (z + next);
    z = next;
  }
  result.end = z;
  return result;
}

Change change(const std::vector<RelaxingSpring>& springs, double H, double RelaxingSpring::*rate) {
  Change sum;
  for (const RelaxingSpring& spring : springs) {
    const Change one = change(spring.*rate, spring.lambda, H);
    sum.end += one.end;
    sum.integral += one.integral;
  }
  return sum;
}

TEST(RelaxingSpring, StandsForSeveralAtTheEndOfAStepAndInItsIntegral) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> decades(0, 1);
  for (int i = 0; i < 20; ++i) {
    const double H = std::pow(10, -4 + 2 * decades(random));
    std::vector<RelaxingSpring> springs(2 + i % 2);
    for (RelaxingSpring& spring : springs) {
      spring = {std::pow(10, 5 + 4 * decades(random)), std::pow(10, -2 + 6 * decades(random)) / H / 100,
                1e6 * (decades(random) - 0.5)};
    }
    const RelaxingSpring one = one_for_all(springs, H);
    const Change all = change(springs, H, &RelaxingSpring::K), its = change({one}, H, &RelaxingSpring::K);
    EXPECT_NEAR(its.end, all.end, 1e-5 * all.end) << i;
    EXPECT_NEAR(its.integral, all.integral, 1e-5 * all.integral) << i;
    double size = 0;
    for (const RelaxingSpring& spring : springs) size += std::fabs(change(spring.F_dot, spring.lambda, H).integral);
    EXPECT_NEAR(change({one}, H, &RelaxingSpring::F_dot).integral, change(springs, H, &RelaxingSpring::F_dot).integral,
                1e-5 * size)
        << i;
  }
}

TEST(RelaxingSpring, OfOneRateIsTheSum) {
  const std::array springs = {RelaxingSpring{2e6, 300, 1e5}, RelaxingSpring{5e6, 300, -3e5}, RelaxingSpring{}};
  const RelaxingSpring one = one_for_all(springs, 1e-3);
  EXPECT_EQ(one.K, 7e6);
  EXPECT_EQ(one.lambda, 300);
  EXPECT_EQ(one.F_dot, -2e5);
}

// for H -> 0 the mean weighted with K
TEST(RelaxingSpring, OfAShortStepHasTheWeightedMean) {
  const std::array springs = {RelaxingSpring{2e6, 20, 1e5}, RelaxingSpring{6e6, 100, 3e5}};
  const RelaxingSpring one = one_for_all(springs, 1e-7);
  EXPECT_NEAR(one.K, 8e6, 1e-4 * 8e6);
  EXPECT_NEAR(one.lambda, 80, 1e-4 * 80);
  EXPECT_NEAR(one.F_dot, 4e5, 1e-4 * 4e5);
}

// a spring that is drained within the step is a damper K/lambda beside a closed one, at any rate
TEST(RelaxingSpring, OfAClosedAndADrainedChamberKeepsTheClosedOne) {
  for (const double lambda : {1e5, 1e7, 1e9, 1e15, 1e300}) {
    const std::array springs = {RelaxingSpring{1e7, 0, 0}, RelaxingSpring{3e7, lambda, 0}};
    const RelaxingSpring one = one_for_all(springs, 1e-3);
    const double share = 3e7 / lambda / (1e7 * 1e-3);  // of the damper in the response
    EXPECT_NEAR(one.K, 1e7, 5 * share * 1e7 + 1) << lambda;
    EXPECT_LT(one.lambda * 1e-3, 8 * share + 1e-6) << lambda;
    EXPECT_GE(one.lambda, 0) << lambda;
  }
}

// the change of a chamber's force runs to its end in a line and stays there
TEST(RelaxingSpring, OfAChamberThatEmptiesHasItsEndAndItsImpulse) {
  constexpr double H = 1e-3, kRoom = -4e3;
  for (const double r : {1e-4, 1e-2, 0.1, 0.3, 0.7, 0.99, 1.0}) {
    const double t_0 = r * H;
    const RelaxingSpring spring = ended_at({5e6, 0, kRoom / t_0}, kRoom, t_0, H);
    EXPECT_NEAR(change(spring.F_dot, spring.lambda, H).end, kRoom, 1e-8 * -kRoom) << r;
    EXPECT_NEAR(change(spring.F_dot, spring.lambda, H).integral, kRoom * (H - t_0 / 2), 1e-5 * -kRoom * H) << r;
    EXPECT_NEAR(change(spring.K, spring.lambda, H).integral, 5e6 * t_0 * t_0 / 2, 1e-5 * 5e6 * t_0 * t_0) << r;
  }
  const RelaxingSpring whole = ended_at({5e6, 200, -3e6}, -3e6 * H * remaining_share(200 * H), H, H);
  EXPECT_NEAR(whole.K, 5e6, 1e-5 * 5e6);
  EXPECT_NEAR(whole.lambda, 200, 1e-3 * 200);
  EXPECT_NEAR(whole.F_dot, -3e6, 1e-5 * 3e6);
}

TEST(RelaxingSpring, IsFiniteWhereNothingIsLeft) {
  const RelaxingSpring none = one_for_all({}, 1e-3);
  EXPECT_EQ(none.K, 0);
  EXPECT_EQ(none.lambda, 0);
  const std::array fast = {RelaxingSpring{1, 1e300, 1}, RelaxingSpring{1e9, 1e200, -1e9}, RelaxingSpring{0, 5, 7}};
  const RelaxingSpring one = one_for_all(fast, 1e-3);
  EXPECT_TRUE(std::isfinite(one.K) && std::isfinite(one.lambda) && std::isfinite(one.F_dot));
}

// the bound keeps the change at the end and the impulse
TEST(RelaxingSpring, OfAResponseIsAtMostAsStiffAsItsBound) {
  constexpr double kH = 1e-3, kMost = 1e7;
  for (const double end : {5e4, 1e6, 5e6, 9.9e6}) {
    const SpringResponse asked{end, 0.999 * end, 3e4};
    EXPECT_GT(spring_with(asked, kH).K, 2 * kMost) << end;
    const RelaxingSpring spring = spring_with(asked, kH, kMost);
    EXPECT_NEAR(spring.K, kMost, 1e-9 * kMost) << end;
    const SpringResponse reached = response_of(spring, kH);
    EXPECT_NEAR(reached.end, end, 1e-9 * end);
    EXPECT_NEAR(reached.impulse, asked.impulse, 1e-9 * asked.impulse);
  }
}

// phi_k = int_0^1 e^{-x(1-t)} t^{k-1}/(k-1)! dt, by Simpson's rule
TEST(RelaxingSpring, DecayedIntegralsAreThoseOfTheirDefinition) {
  for (const double x : {0.0, 1e-9, 1e-3, 0.3, 1.999, 2.001, 4.0, 30.0}) {
    double sums[5] = {0, 0, 0, 0, 0};
    constexpr int kParts = 4000;
    for (int i = 0; i <= kParts; ++i) {
      const double t = static_cast<double>(i) / kParts, weight = i == 0 || i == kParts ? 1 : (i % 2 == 1 ? 4 : 2);
      double term = weight * std::exp(-x * (1 - t)) / (3.0 * kParts);
      for (int k = 0; k < 5; ++k) sums[k] += term, term *= t / (k + 1);
    }
    const DecayedIntegrals phi = decayed_integrals(x);
    EXPECT_NEAR(phi.phi_1, sums[0], 1e-10 * sums[0]) << x;
    EXPECT_NEAR(phi.phi_2, sums[1], 1e-10 * sums[1]) << x;
    EXPECT_NEAR(phi.phi_3, sums[2], 1e-10 * sums[2]) << x;
    EXPECT_NEAR(phi.phi_4, sums[3], 1e-10 * sums[3]) << x;
    EXPECT_NEAR(phi.phi_5, sums[4], 1e-10 * sums[4]) << x;
  }
}

}  // namespace relaxing_spring_test
}  // namespace slew::math
