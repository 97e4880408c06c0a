// Adaptive RODAS3: L-stable Rosenbrock method of four stages, order 3 with an embedded order 2, for y' = f(y).
//
//   (1/(h gamma) I - J) K_i = f(y + sum_j a_ij K_j) + 1/h sum_j c_ij K_j,   gamma = 1/2                      (1)
//   K_1, K_2 at y;  K_3 at y + 2 K_1;  K_4 at y + 2 K_1 + K_3                                                (2)
//   c_21 = 4;  c_31 = 1, c_32 = -1;  c_41 = 1, c_42 = -1, c_43 = -8/3                                        (3)
//   y_new = y + 2 K_1 + K_3 + K_4,   error = K_4                                                             (4)
// A step needs three f, one J, one LU and four solves. A step is accepted when max |K_4,i| / (rtol (s_i + r_i |y_i|))
// <= 1; the next size is h clip(0.9 err^(-1/3), 0.2, 6).
//
// Source: A. Sandu et al. 1997, Atmos. Environ. 31, 3459 (RODAS3); form (1) as in Hairer and Wanner 1996, IV.7.
// The step size is carried over from one interval to the next and is part of the state. Real-time safe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "math/dense_lu.h"
#include "math/pattern_lu.h"

namespace slew::math {

// y' = f(y), constant inputs over an interval.
class StiffSystem {
 public:
  virtual ~StiffSystem() = default;
  virtual void derivative(const double* y, double* f) noexcept = 0;
  // J = df/dy at y, f = f(y) given; row-major with the stride stated to Rodas3. Valid until the next call.
  virtual const double* jacobian(const double* y, const double* f) noexcept = 0;
  // A sub-step from y_before (derivative f_before) to y was accepted; may move y back into its bounds.
  virtual void accepted(double h, const double* y_before, const double* f_before, double* y) noexcept = 0;
};

struct Rodas3Options {
  double relative_tolerance = 1e-4;
  double minimum_step = 1e-6;          // s
  std::uint32_t substep_budget = 200;  // accepted and rejected sub-steps per interval
  std::vector<double> scale;           // s_i of the error measure, one per state, > 0
  std::vector<double> relative;        // r_i: 1, or 0 for a state whose zero is arbitrary (a position)
};

struct Rodas3Report {
  std::uint32_t accepted = 0;
  std::uint32_t rejected = 0;
  std::uint32_t dense_factorisations = 0;  // when a diagonal pivot was too small
  bool is_over_budget = false;             // the rest of the interval was accepted with its error
  bool is_at_minimum_step = false;         // a step was accepted with its error because it could not be shorter
  bool is_finite = true;                   // false: y is the last finite state, the interval is not finished
  double largest_error = 0;                // of the accepted steps, 1 = tolerance
  std::int32_t worst_state = -1;           // the state with that error; when not finite: the first such state
};

class Rodas3 {
 public:
  Rodas3(const SparsityPattern& pattern, std::size_t jacobian_stride, Rodas3Options options);

  // Advances y by `duration` seconds.
  Rodas3Report advance(StiffSystem& system, std::span<double> y, double duration) noexcept;

  // Integral of a state over the step that is being accepted, from y_before, as the method would integrate it as a
  // state of its own: what flows out of one state and into another is the same. For StiffSystem::accepted() only.
  [[nodiscard]] double integral(std::size_t state, double y_before, double h) const noexcept;

  // Size that the next sub-step would like to have; set it back to 0 after a jump of the state.
  [[nodiscard]] double step_size() const noexcept { return step_size_; }
  void set_step_size(double h) noexcept { step_size_ = h; }

 private:
  [[nodiscard]] bool factorise(const double* J, double c, Rodas3Report& report) noexcept;
  void solve(double* b) noexcept;
  [[nodiscard]] std::int32_t first_non_finite() const noexcept;
  [[nodiscard]] double next_step(double wanted_before, double used, double factor, double longest) const noexcept;
  [[nodiscard]] double try_step(StiffSystem& system, const double* y, double h) noexcept;

  std::size_t size_;
  std::size_t stride_;
  Rodas3Options options_;
  PatternLu lu_;
  DenseLu dense_;
  bool uses_dense_ = false;
  std::int32_t worst_ = -1;  // of the last step tried
  double step_size_ = 0;
  std::vector<double> f_, k1_, k2_, k3_, k4_, stage_, new_;
};

}  // namespace slew::math
