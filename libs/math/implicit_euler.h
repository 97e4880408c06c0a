// SPDX-License-Identifier: Apache-2.0
// Implicit Euler with a fixed sub-step: order 1, L-stable, with strong numerical damping.
//
//   M (y_new - y) / h = f(y_new)                                                                            (1)
//   (M/h - J) d = f(y_k) - M (y_k - y)/h,  y_k+1 = y_k + d                                     Newton       (2)
//   w(y_new) - w(y) = h w'(y_new) f(y_new)       in place of (1), of a state with a measure w               (3)
// (3) keeps sums of what such states store to rounding (StiffSystem::measure()).
//
// h is the interval over the smallest whole number that brings it to maximum_step or below. Newton takes a fresh
// Jacobian each iteration and ends when max |d_i| / (rtol (s_i + r_i |y_i|)) <= 0.1. A sub-step whose iteration does
// not converge, or that does not keep the system's balance (StiffSystem::impossible_state(), unbalanced_state()), is
// repeated with half its length (counted as rejected) down to kShortestShare of minimum_step, or to minimum_step once
// substep_budget is used up. There it is accepted and reported; an impossible one ends the interval. Source: Hairer and
// Wanner 1996, IV.8. Real-time safe.
#pragma once

#include "math/stage_matrix.h"
#include "math/stiff_system.h"

namespace slew::math {

class ImplicitEuler final : public StiffIntegrator {
 public:
  ImplicitEuler(const SparsityPattern& pattern, std::size_t jacobian_stride, StiffOptions options);

  StiffReport advance(StiffSystem& system, std::span<double> y, double duration) noexcept override;
  void restart() noexcept override {}
  [[nodiscard]] double step_size() const noexcept override { return options_.maximum_step; }
  void set_step_size(double) noexcept override {}
  [[nodiscard]] double integral(const StateFunction& g, std::size_t state, double h, const double*, const double*,
                                const double* y) const noexcept override {
    return h * g.at(y[state]).value;
  }
  [[nodiscard]] bool takes_algebraic_rows() const noexcept override { return true; }
  void set_mass(std::span<const double> mass) noexcept override { matrix_.set_mass(mass); }

 private:
  [[nodiscard]] double last_correction(const double* y) const noexcept;
  struct Newton {
    bool has_converged = false;
    bool is_finite = true;
    double last = 0;  // size of the last correction, 1 = the bound of convergence
    std::int32_t worst = -1;
  };
  Newton try_step(StiffSystem& system, const double* y, double h, StiffReport& report) noexcept;
  [[nodiscard]] const double* stamp_measures(const StiffSystem& system, const double* y, const double* J,
                                             double c) noexcept;
  [[nodiscard]] bool solve(const double* J, double c, StiffReport& report) noexcept;

  std::size_t size_;
  StiffOptions options_;
  StageMatrix matrix_;
  std::vector<double> f_, new_, slope_, d_;
  std::size_t stride_;
  std::vector<double> grown_, storage_, measured_J_;  // (w(y_k) - w(y))/w'(y_k), w'(y_k); J of (2) with (3)
};

}  // namespace slew::math
