// SPDX-License-Identifier: Apache-2.0
// Classical Runge-Kutta of order 4 with a fixed sub-step, for systems that are not stiff.
//
//   y_new = y + h/6 (k_1 + 2 k_2 + 2 k_3 + k_4)                                                             (1)
//
// h is the interval over the smallest whole number that brings it to maximum_step or below. There is no error control;
// stability is checked: h |lambda|_max by power iteration on the Jacobian has to stay below 2 (the method's limit: 2.79
// on the real axis, 2.83 on the imaginary one), at the start of every interval and at sub-steps, at most four an
// interval, whose stages are suspicious:
//   2 |k_3 - k_2| / |k_2 - k_1| > 2                       h times the growth of J along k_2 - k_1               (2)
// The Jacobian sees one side of a law that turns: a valve that swings between open and closed is soft at one end of a
// sub-step and stiff at the other. Every sub-step is therefore compared with the formula of order 2 that takes k_2 in
// place of k_3, and reported as too long where
//   h/3 |k_3 - k_2| > 0.01 (scale + max |y|, |y_new|)     of any state                                          (3)
// or where its end is impossible (StiffSystem::impossible_state()). Of the error it makes, a share of the same size,
//   h/3 |k_3 - k_2| min(1, 0.4 r^2),  r = |k_3 - k_2| / |k_2 - k_1|                                         (4)
// is counted as accepted, of an impossible one that of kGrossShare. In y' = lambda y with z = h |lambda| the left side
// of (3) is z^3/12 |y|, r = z/2, and (4) z^5/120 |y|: the error of order 5 of the method.
// Source: Hairer, Norsett and Wanner 1993, II.1; limits: Hairer and Wanner 1996, IV.2. Real-time safe.
#pragma once

#include "math/spectral_radius.h"
#include "math/stiff_system.h"

namespace slew::math {

inline constexpr double kExplicitLimit = 2;  // limit of h |lambda|_max

class RungeKutta4 final : public StiffIntegrator {
 public:
  RungeKutta4(std::size_t jacobian_stride, StiffOptions options);

  StiffReport advance(StiffSystem& system, std::span<double> y, double duration) noexcept override;
  void restart() noexcept override;
  [[nodiscard]] double step_size() const noexcept override { return options_.maximum_step; }
  void set_step_size(double) noexcept override {}
  void save(StateWriter& bytes) const override {
    bytes.flag(is_first_);
    radius_.save(bytes);
  }
  void load(StateReader& bytes) noexcept override {
    bytes.flag(is_first_);
    radius_.load(bytes);
  }

 private:
  void watch_error(StiffSystem& system, const double* y, double h, StiffReport& report) noexcept;
  void watch(StiffSystem& system, const double* y, const double* f, double h, int iterations,
             StiffReport& report) noexcept;
  // Norms of k_3 - k_2 and k_2 - k_1 in the states' scales, squared.
  struct Differences {
    double later = 0, earlier = 0;
  };
  [[nodiscard]] Differences differences() const noexcept;
  [[nodiscard]] bool is_suspicious() const noexcept;

  StiffOptions options_;
  SpectralRadius radius_;
  bool is_first_ = true;
  std::vector<double> f_, k2_, k3_, k4_, stage_, new_;
};

}  // namespace slew::math
