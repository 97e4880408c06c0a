// SPDX-License-Identifier: Apache-2.0
#include "monolith/eigenmodes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace slew::monolith {
namespace eigenmodes_test {

// x'' = -w2 x - 2 z w x'
std::vector<double> oscillator(double w, double z) {
  return {0, 1, -w * w, -2 * z * w};
}

// block diagonal
std::vector<double> joined(const std::vector<std::vector<double>>& blocks, const std::vector<std::size_t>& sizes) {
  const std::size_t n = std::accumulate(sizes.begin(), sizes.end(), std::size_t{0});
  std::vector<double> A(n * n);
  std::size_t first = 0;
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    for (std::size_t i = 0; i < sizes[b]; ++i) {
      for (std::size_t j = 0; j < sizes[b]; ++j) A[(first + i) * n + first + j] = blocks[b][i * sizes[b] + j];
    }
    first += sizes[b];
  }
  return A;
}

TEST(Eigenmodes, AnOscillatorHasItsClosedForm) {
  const double w = 300, z = 0.02;
  const Eigenmodes found = eigenmodes(oscillator(w, z), 2);
  ASSERT_EQ(found.modes.size(), 1u);
  EXPECT_EQ(found.at_rest, 0);
  EXPECT_NEAR(found.modes[0].value.real(), -z * w, 1e-10 * w);
  EXPECT_NEAR(found.modes[0].value.imag(), w * std::sqrt(1 - z * z), 1e-10 * w);
  // position and speed take part alike
  EXPECT_NEAR(found.modes[0].participation[0], 0.5, 1e-9);
}

TEST(Eigenmodes, ParticipationDoesNotDependOnUnits) {
  // an oscillator on a slow first-order state, coupled both ways
  const std::vector<double> A = {0, 1, 0, -900, -3, 5, 2, 0, -40};
  const std::vector<double> scale = {1e-6, 1e3, 1e7};
  std::vector<double> scaled(9);
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) scaled[i * 3 + j] = A[i * 3 + j] * scale[i] / scale[j];
  }
  const Eigenmodes plain = eigenmodes(A, 3), other = eigenmodes(scaled, 3);
  ASSERT_EQ(plain.modes.size(), other.modes.size());
  for (std::size_t k = 0; k < plain.modes.size(); ++k) {
    EXPECT_NEAR(std::abs(plain.modes[k].value - other.modes[k].value), 0, 1e-9 * 30);
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_NEAR(plain.modes[k].participation[i], other.modes[k].participation[i], 1e-8);
    }
  }
}

TEST(Eigenmodes, EachModeBelongsToItsOwnBlock) {
  const Eigenmodes found = eigenmodes(joined({oscillator(5, 0.1), {-2000}, oscillator(80, 0)}, {2, 1, 2}), 5);
  ASSERT_EQ(found.modes.size(), 3u);
  EXPECT_NEAR(found.modes[0].participation[2], 1, 1e-9);
  EXPECT_NEAR(found.modes[1].participation[3] + found.modes[1].participation[4], 1, 1e-9);
  EXPECT_NEAR(found.modes[2].participation[0] + found.modes[2].participation[1], 1, 1e-9);
}

TEST(Eigenmodes, EqualOnesAreReportedTogether) {
  // three spools of one time constant, of which one drives an oscillator
  const std::vector<double> A = {-30, 0, 0, 0, 0, 0, -30, 0, 0, 0, 0, 0, -30, 0, 0, 0, 0, 0, 0, 1, 4, 0, 0, -900, -1};
  const Eigenmodes found = eigenmodes(A, 5);
  ASSERT_EQ(found.modes.size(), 2u);
  const Eigenmode& spools = found.modes[0].count == 3 ? found.modes[0] : found.modes[1];
  ASSERT_EQ(spools.count, 3);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(spools.participation[i], 1.0 / 3, 1e-6);
}

TEST(Eigenmodes, WhatNothingRestoresIsAtRest) {
  // a free mass beside an oscillator: a double zero with one vector
  const Eigenmodes found = eigenmodes(joined({{0, 1, 0, 0}, oscillator(10, 0.3)}, {2, 2}), 4);
  EXPECT_EQ(found.at_rest, 2);
  ASSERT_EQ(found.modes.size(), 1u);
  EXPECT_NEAR(std::abs(found.modes[0].value), 10, 1e-9);
}

// the border of the classical method on both axes: Hairer and Wanner 1996, table 2.1
TEST(Eigenmodes, RungeKuttaEndsWhereItsStabilityRegionDoes) {
  EXPECT_NEAR(longest_runge_kutta_step({-1000, 0}), 2.785293563e-3, 1e-9);
  EXPECT_NEAR(longest_runge_kutta_step({0, 500}), 2 * std::sqrt(2.0) / 500, 1e-5);
  EXPECT_TRUE(std::isinf(longest_runge_kutta_step({3, 10})));
}

}  // namespace eigenmodes_test
}  // namespace slew::monolith
