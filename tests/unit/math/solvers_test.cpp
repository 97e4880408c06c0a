// SPDX-License-Identifier: Apache-2.0
// Runge-Kutta, implicit Euler and CVODE as integrators of an abstract system, and algebraic rows.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "math/cvode_stepper.h"
#include "math/implicit_euler.h"
#include "math/rodas3.h"
#include "math/runge_kutta4.h"

namespace slew::math {
namespace solvers_test {

// x'' = -w^2 x
class Oscillator final : public StiffSystem {
 public:
  void derivative(const double* y, double* f) noexcept override { f[0] = y[1], f[1] = -100 * y[0]; }
  const double* jacobian(const double*, const double*) noexcept override { return J_; }
  void accepted(double h, const double*, const double*, double*) noexcept override { time += h; }
  double time = 0;

 private:
  double J_[4] = {0, 1, -100, 0};
};

StiffOptions options(double tolerance, double step) {
  return {.relative_tolerance = tolerance, .maximum_step = step, .scale = {1, 10}, .relative = {0, 0}};
}

SparsityPattern full(std::size_t n) {
  SparsityPattern pattern(n);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) pattern.add(i, j);
  }
  return pattern;
}

double error_after_one_second(StiffIntegrator& solver) {
  Oscillator system;
  double y[] = {1, 0};
  for (int k = 0; k < 100; ++k) EXPECT_TRUE(solver.advance(system, y, 0.01).is_finite);
  EXPECT_NEAR(system.time, 1, 1e-12);
  return std::hypot(y[0] - std::cos(10.0), (y[1] + 10 * std::sin(10.0)) / 10);
}

TEST(RungeKutta4, is_of_fourth_order) {
  RungeKutta4 coarse(2, options(1, 0.01)), fine(2, options(1, 0.005));
  EXPECT_NEAR(std::log2(error_after_one_second(coarse) / error_after_one_second(fine)), 4, 0.1);
}

TEST(RungeKutta4, reports_when_a_state_moves_by_more_than_a_step_follows) {
  for (const double step : {0.03, 0.15}) {
    Oscillator system;
    double y[] = {1000, 0};
    RungeKutta4 solver(2, options(1, step));
    const StiffReport report = solver.advance(system, y, step);
    EXPECT_LT(report.largest_error, 1) << step;  // in units of the limit
    EXPECT_EQ(report.is_unstable, step > 0.1);
  }
}

TEST(RungeKutta4, reports_when_its_step_is_beyond_the_limit) {
  Oscillator system;
  double y[] = {0.01, 0};  // small beside its scale: what moves is followed well enough
  RungeKutta4 stable(2, options(1, 0.15)), unstable(2, options(1, 0.25));
  const StiffReport good = stable.advance(system, y, 0.3), bad = unstable.advance(system, y, 0.5);
  EXPECT_FALSE(good.is_unstable);
  EXPECT_NEAR(good.largest_error, 0.15 * 10 / kExplicitLimit, 0.02);
  EXPECT_TRUE(bad.is_unstable);
  EXPECT_GE(bad.worst_state, 0);
}

// y' = -lambda y in one step
class Decay final : public StiffSystem {
 public:
  void derivative(const double* y, double* f) noexcept override { f[0] = -y[0]; }
  const double* jacobian(const double*, const double*) noexcept override { return J_; }
  void accepted(double, const double*, const double*, double*) noexcept override {}

 private:
  double J_[1] = {-1};
};

TEST(RungeKutta4, counts_the_error_that_a_step_makes) {
  for (const double z : {1.0, 1.5, 1.9}) {
    Decay system;
    double y[] = {1};
    RungeKutta4 solver(1, {.relative_tolerance = 1, .maximum_step = z, .scale = {1e-9}, .relative = {0}});
    const StiffReport report = solver.advance(system, y, z);
    EXPECT_TRUE(report.is_unstable) << z;
    EXPECT_NEAR(report.accepted_error, std::pow(z, 5) / 120, 1e-6) << z;
    const double error = std::fabs(y[0] - std::exp(-z));
    EXPECT_GT(report.accepted_error, error) << z;
    EXPECT_LT(report.accepted_error, 1.5 * error) << z;
  }
  Decay system;
  double y[] = {1};
  RungeKutta4 solver(1, {.relative_tolerance = 1, .maximum_step = 0.3, .scale = {1e-9}, .relative = {0}});
  EXPECT_EQ(solver.advance(system, y, 0.3).accepted_error, 0);
}

TEST(ImplicitEuler, is_of_first_order_and_damps) {
  ImplicitEuler coarse(full(2), 2, options(1e-9, 1e-4)), fine(full(2), 2, options(1e-9, 5e-5));
  const double error = error_after_one_second(coarse);
  EXPECT_NEAR(error / error_after_one_second(fine), 2, 0.02);
  EXPECT_NEAR(error, 0.5 * 100 * 1e-4, 1e-3);  // exp(-w^2 h t / 2) of the oscillation remains
}

TEST(Cvode, is_within_its_tolerance_over_many_intervals) {
  for (const double tolerance : {1e-4, 1e-6, 1e-8}) {
    CvodeStepper solver(2, options(tolerance, 1));
    EXPECT_LT(error_after_one_second(solver), 2 * tolerance) << tolerance;
  }
}

TEST(Cvode, keeps_its_past_until_a_jump_is_reported) {
  Oscillator system;
  CvodeStepper solver(2, options(1e-6, 1));
  double y[] = {1, 0};
  EXPECT_EQ(solver.advance(system, y, 0.01).restarts, 1u);
  EXPECT_EQ(solver.advance(system, y, 0.01).restarts, 0u);
  y[0] += 1e-6;  // a coupling's correction
  EXPECT_EQ(solver.advance(system, y, 0.01).restarts, 0u);
  y[0] += 1e-2;  // another state
  EXPECT_EQ(solver.advance(system, y, 0.01).restarts, 1u);
  solver.inputs_jumped();
  EXPECT_EQ(solver.advance(system, y, 0.01).restarts, 1u);
}

TEST(Cvode, carries_a_small_correction_into_what_follows) {
  Oscillator system;
  CvodeStepper solver(2, options(1e-9, 1));
  double y[] = {1, 0};
  static_cast<void>(solver.advance(system, y, 0.05));
  y[0] += 5e-4;
  const double x = y[0], v = y[1];
  EXPECT_EQ(solver.advance(system, y, 0.05).restarts, 0u);
  EXPECT_NEAR(y[0], x * std::cos(0.5) + v / 10 * std::sin(0.5), 1e-6);
}

TEST(Cvode, has_a_hash_that_its_past_decides) {
  Oscillator system;
  CvodeStepper one(2, options(1e-6, 1)), other(2, options(1e-6, 1));
  double y[] = {1, 0}, z[] = {1, 0};
  const auto hash = [](const CvodeStepper& solver) {
    StateHash result;
    solver.add_to(result);
    return result.digest();
  };
  for (int k = 0; k < 5; ++k) {
    static_cast<void>(one.advance(system, y, 0.01));
    static_cast<void>(other.advance(system, z, 0.01));
    EXPECT_EQ(hash(one), hash(other));
  }
  other.restart();
  static_cast<void>(one.advance(system, y, 0.01));
  static_cast<void>(other.advance(system, z, 0.01));
  EXPECT_NE(hash(one), hash(other));
}

// x' = -z, 0 = L (x^3 - z): x = 1 / sqrt(1 + 2 t). A square would be no test: linearly implicit methods meet it
// exactly.
class Algebraic final : public StiffSystem {
 public:
  void derivative(const double* y, double* f) noexcept override {
    f[0] = -y[1], f[1] = kL * (y[0] * y[0] * y[0] - y[1]);
  }
  const double* jacobian(const double* y, const double*) noexcept override {
    J_[2] = 3 * kL * y[0] * y[0];
    return J_;
  }
  void accepted(double, const double*, const double*, double*) noexcept override {}

 private:
  static constexpr double kL = 1e5;
  double J_[4] = {0, -1, 0, -kL};
};

double algebraic_error(StiffIntegrator& solver, int steps) {
  constexpr double kMass[] = {1, 0};
  EXPECT_TRUE(solver.takes_algebraic_rows());
  solver.set_mass(kMass);
  Algebraic system;
  double y[] = {1, 1};
  solver.set_step_size(1);
  for (int k = 0; k < steps; ++k) EXPECT_EQ(solver.advance(system, y, 1.0 / steps).accepted, 1u);
  EXPECT_NEAR(y[1], y[0] * y[0] * y[0], 1e-4);
  return std::fabs(y[0] - 1 / std::sqrt(3.0));
}

TEST(AlgebraicRows, keep_the_order_of_rodas3) {
  const auto solver = [] {
    return Rodas3(full(2), 2, {.relative_tolerance = 1e9, .scale = {1, 1}, .relative = {1, 1}});
  };
  Rodas3 coarse = solver(), fine = solver();
  EXPECT_NEAR(std::log2(algebraic_error(coarse, 20) / algebraic_error(fine, 40)), 3, 0.3);
}

TEST(AlgebraicRows, keep_the_order_of_implicit_euler) {
  ImplicitEuler coarse(full(2), 2, options(1e-9, 1)), fine(full(2), 2, options(1e-9, 1));
  EXPECT_NEAR(algebraic_error(coarse, 100) / algebraic_error(fine, 200), 2, 0.05);
}

TEST(AlgebraicRows, are_not_for_explicit_methods_and_cvode) {
  EXPECT_FALSE(RungeKutta4(2, options(1, 1)).takes_algebraic_rows());
  EXPECT_FALSE(CvodeStepper(2, options(1, 1)).takes_algebraic_rows());
}

}  // namespace solvers_test
}  // namespace slew::math
