// SPDX-License-Identifier: Apache-2.0
// The linear solvers and the Rosenbrock method that the circuit stands on.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "math/dense_lu.h"
#include "math/pattern_lu.h"
#include "math/rodas3.h"

namespace slew::math {
namespace stiff_test {

TEST(DenseLu, solves_a_system_that_needs_row_exchanges) {
  DenseLu lu(3);
  const double A[] = {0, 2, 1, 1, 0, 0, 3, 1, 4};
  std::copy(std::begin(A), std::end(A), lu.matrix().begin());
  ASSERT_TRUE(lu.factorise());
  double b[] = {2 * 2 + 3, 1, 3 + 2 + 12};
  lu.solve(b);
  EXPECT_DOUBLE_EQ(b[0], 1);
  EXPECT_DOUBLE_EQ(b[1], 2);
  EXPECT_DOUBLE_EQ(b[2], 3);
}

TEST(DenseLu, refuses_a_singular_matrix) {
  DenseLu lu(2);
  const double A[] = {1, 2, 2, 4};
  std::copy(std::begin(A), std::end(A), lu.matrix().begin());
  EXPECT_FALSE(lu.factorise());
}

TEST(PatternLu, agrees_with_dense_elimination_on_random_patterns) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int trial = 0; trial < 200; ++trial) {
    const std::size_t n = 1 + random() % 25, stride = n + random() % 3;
    SparsityPattern pattern(n);
    std::vector<double> J(stride * n, 0), b(n), x(n);
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < n; ++j) {
        if (i != j && random() % 4 != 0) continue;
        pattern.add(i, j);
        J[i * stride + j] = unit(random);
      }
      b[i] = x[i] = unit(random);
    }
    const double c = 8;
    PatternLu sparse(pattern, stride);
    DenseLu dense(n);
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < n; ++j) dense.matrix()[i * n + j] = (i == j ? c : 0) - J[i * stride + j];
    }
    ASSERT_TRUE(sparse.factorise(J.data(), c));
    ASSERT_TRUE(dense.factorise());
    sparse.solve(b.data());
    dense.solve(x);
    for (std::size_t i = 0; i < n; ++i) EXPECT_NEAR(b[i], x[i], 1e-12);
  }
}

TEST(PatternLu, reports_a_vanishing_pivot) {
  SparsityPattern pattern(2);
  pattern.add(0, 1), pattern.add(1, 0);
  PatternLu lu(pattern, 2);
  const double J[] = {10, 3, 3, 10};  // 10 I - J has no diagonal
  EXPECT_FALSE(lu.factorise(J, 10));
}

// x'' = -w^2 x with a stiff follower z' = -L (z - x).
class StiffOscillator final : public StiffSystem {
 public:
  void derivative(const double* y, double* f) noexcept override {
    f[0] = y[1], f[1] = -kW * kW * y[0], f[2] = -kL * (y[2] - y[0]);
  }
  const double* jacobian(const double*, const double*) noexcept override { return J_; }
  void accepted(double h, const double*, const double*, double*) noexcept override { time += h; }
  static constexpr double kW = 10, kL = 1e5;
  double time = 0;

 private:
  double J_[9] = {0, 1, 0, -kW* kW, 0, 0, kL, 0, -kL};
};

Rodas3 oscillator_solver(double tolerance, std::uint32_t budget = 200) {
  SparsityPattern pattern(3);
  pattern.add(0, 1), pattern.add(1, 0), pattern.add(2, 0);
  return Rodas3(
      pattern, 3,
      {.relative_tolerance = tolerance, .substep_budget = budget, .scale = {1, 10, 1}, .relative = {1, 1, 1}});
}

TEST(Rodas3, follows_a_stiff_oscillator_within_its_tolerance) {
  StiffOscillator system;
  for (const double tolerance : {1e-3, 1e-4, 1e-5, 1e-6}) {
    Rodas3 solver = oscillator_solver(tolerance);
    double y[] = {1, 0, 1};
    std::uint32_t steps = 0;
    for (int k = 0; k < 100; ++k) steps += solver.advance(system, y, 0.01).accepted;
    EXPECT_NEAR(y[0], std::cos(10.0), 60 * tolerance) << tolerance;
    EXPECT_NEAR(y[2], y[0], 3 * StiffOscillator::kW / StiffOscillator::kL + 10 * tolerance);
    // explicit methods would need 1e5 / 2.8 steps
    EXPECT_LT(steps, 5000u);
  }
}

// three periods in one interval: at 1e-10 they take 2500 sub-steps, at 1e-4 about 90
TEST(Rodas3, goes_on_at_a_looser_tolerance_where_the_budget_is_used_up) {
  for (const std::uint32_t budget : {200u, 500u, 1000u}) {
    StiffOscillator system;
    Rodas3 solver = oscillator_solver(1e-10, budget);
    double y[] = {1, 0, 1};
    const double t = 6 * 3.141592653589793 / StiffOscillator::kW;
    const StiffReport report = solver.advance(system, y, t);
    EXPECT_NEAR(system.time, t, 1e-12);
    EXPECT_TRUE(report.is_over_budget);
    EXPECT_LT(report.accepted + report.rejected, 2 * budget);
    EXPECT_GT(report.largest_error, 1);
    EXPECT_LE(report.largest_error * 1e-10, 1.0001 * kSoundShare);
    EXPECT_EQ(report.accepted_error, 0);
    EXPECT_NEAR(y[0], 1, 60 * kSoundShare) << budget;
    EXPECT_NEAR(y[1] / StiffOscillator::kW, 0, 60 * kSoundShare) << budget;
  }
}

TEST(Rodas3, adds_up_the_errors_that_it_accepts) {
  StiffOscillator system;
  Rodas3 solver = oscillator_solver(1e-6, 12);
  double y[] = {1, 0, 1};
  const StiffReport report = solver.advance(system, y, 0.5);
  EXPECT_TRUE(report.is_over_budget);
  ASSERT_FALSE(report.is_impossible);
  const double error = std::hypot(y[0] - std::cos(5.0), y[1] / 10 + std::sin(5.0));
  EXPECT_GT(error, 10 * kSoundShare);
  EXPECT_GT(report.accepted_error, error / 3);
  EXPECT_LE(report.accepted_error, report.accepted * report.largest_error * 1e-6);
}

TEST(Rodas3, is_of_third_order) {
  // tolerance out of the way: the step is the interval
  StiffOscillator system;
  double error[3];
  for (int i = 0; i < 3; ++i) {
    Rodas3 solver = oscillator_solver(1e9);
    double y[] = {1, 0, 1};
    const int n = 50 << i;
    solver.set_step_size(1);
    for (int k = 0; k < n; ++k) EXPECT_EQ(solver.advance(system, y, 1.0 / n).accepted, 1u);
    error[i] = std::hypot(y[0] - std::cos(10.0), (y[1] + 10 * std::sin(10.0)) / 10);
  }
  EXPECT_NEAR(std::log2(error[0] / error[1]), 3, 0.25);
  EXPECT_NEAR(std::log2(error[1] / error[2]), 3, 0.15);
}

TEST(Rodas3, covers_the_interval_exactly_and_carries_its_step_size_on) {
  StiffOscillator system;
  Rodas3 solver = oscillator_solver(1e-5);
  double y[] = {1, 0, 1};
  const StiffReport report = solver.advance(system, y, 0.1);
  EXPECT_NEAR(system.time, 0.1, 1e-15);
  EXPECT_GT(report.accepted, 5u);
  EXPECT_GT(solver.step_size(), 1e-4);
  EXPECT_LT(solver.step_size(), 0.1);
  EXPECT_EQ(report.dense_factorisations, 0u);
}

// A speed that falls by 2 m/s2 into friction that is linear with a slope of 4e5 1/s below 1e-4 m/s, as a cylinder's is.
class ComesToRest final : public StiffSystem {
 public:
  explicit ComesToRest(bool foresees) : foresees_(foresees) {}
  void derivative(const double* y, double* f) noexcept override {
    f[0] = kSlope * (kEdge - std::clamp(y[0], -kEdge, kEdge)) - 2;
  }
  const double* jacobian(const double* y, const double*) noexcept override {
    J_ = std::fabs(y[0]) < kEdge ? -kSlope : 0;
    return &J_;
  }
  void accepted(double h, const double*, const double*, double* y) noexcept override {
    time += h;
    if (y[0] < kEdge && first_inside == 0) first_inside = time;
  }
  double time_to_bend(const double* y, const double* f, const double*) noexcept override {
    if (!foresees_ || y[0] < kEdge) return std::numeric_limits<double>::infinity();
    return (y[0] > 1.01 * kEdge ? y[0] - 1.005 * kEdge : y[0] - 0.97 * kEdge) / -f[0];
  }
  static constexpr double kEdge = 1e-4, kSlope = 4e5;
  double time = 0, first_inside = 0;

 private:
  bool foresees_;
  double J_ = 0;
};

Rodas3 rest_solver(double tolerance = 1e-4) {
  return Rodas3(SparsityPattern(1), 1,
                {.relative_tolerance = tolerance, .minimum_step = 1e-8, .scale = {0.1}, .relative = {1}});
}

TEST(Rodas3, ends_a_step_before_a_bend_that_the_system_foresees) {
  std::uint32_t tried[2];
  for (const bool foresees : {false, true}) {
    ComesToRest system(foresees);
    Rodas3 solver = rest_solver();
    solver.set_step_size(1e-3);
    double y[] = {1e-3};
    const StiffReport report = solver.advance(system, y, 1e-3);
    tried[foresees] = report.accepted + report.rejected;
    EXPECT_NEAR(system.time, 1e-3, 1e-12);
    EXPECT_NEAR(y[0], ComesToRest::kEdge - 2 / ComesToRest::kSlope, 1e-6);
    EXPECT_NEAR(system.first_inside, (1e-3 - ComesToRest::kEdge) / 2, 1e-4);
    EXPECT_FALSE(report.is_at_minimum_step);
    // the size before the bend is kept
    if (foresees) {
      EXPECT_GT(solver.step_size(), 5e-4);
    }
  }
  EXPECT_LE(tried[1], 6u);
  EXPECT_GE(tried[0], 2 * tried[1]);
}

TEST(Rodas3, shrinks_by_the_order_that_two_rejections_show) {
  // far from rest inside the steep part: the error hardly falls until the step resolves 2.5 us
  ComesToRest system(false);
  Rodas3 solver = rest_solver(1e-5);
  solver.set_step_size(1e-3);
  double y[] = {2e-5};
  const StiffReport report = solver.advance(system, y, 1e-3);
  EXPECT_NEAR(y[0], ComesToRest::kEdge - 2 / ComesToRest::kSlope, 1e-6);
  // not one by one as h^3 would require
  EXPECT_GE(report.rejected, 1u);
  EXPECT_LE(report.rejected, 5u);
}

// Growth so strong that 1/(h gamma) - J vanishes on the diagonal at the first step tried.
class Growth final : public StiffSystem {
 public:
  void derivative(const double* y, double* f) noexcept override { f[0] = 200 * y[0] + y[1], f[1] = -y[1]; }
  const double* jacobian(const double*, const double*) noexcept override { return J_; }
  void accepted(double, const double*, const double*, double*) noexcept override {}

 private:
  double J_[4] = {200, 1, 0, -1};
};

TEST(Rodas3, survives_a_vanishing_diagonal) {
  SparsityPattern pattern(2);
  pattern.add(0, 1);
  Growth system;
  Rodas3 solver(pattern, 2, {.relative_tolerance = 1e-6, .scale = {1, 1}, .relative = {1, 1}});
  solver.set_step_size(0.01);  // 1/(0.01/2) = 200
  double y[] = {1, 0};
  const StiffReport report = solver.advance(system, y, 0.01);
  EXPECT_TRUE(report.is_finite);
  EXPECT_NEAR(y[0], std::exp(2.0), 1e-3);
}

}  // namespace stiff_test
}  // namespace slew::math
