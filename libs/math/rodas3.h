// SPDX-License-Identifier: Apache-2.0
// Adaptive RODAS3: L-stable Rosenbrock method of four stages, order 3 with an embedded order 2, for M y' = f(y).
//
//   (1/(h gamma) M - J) K_i = f(y + sum_j a_ij K_j) + M/h sum_j c_ij K_j,   gamma = 1/2                      (1)
//   K_1, K_2 at y;  K_3 at y + 2 K_1;  K_4 at y + 2 K_1 + K_3                                                (2)
//   c_21 = 4;  c_31 = 1, c_32 = -1;  c_41 = 1, c_42 = -1, c_43 = -8/3                                        (3)
//   y_new = y + 2 K_1 + K_3 + K_4,   error = K_4                                                             (4)
// A step needs three f, one J, one LU and four solves. A step is accepted when max |K_4,i| / (rtol (s_i + r_i |y_i|))
// <= 1 and the system holds it for possible (StiffSystem::impossible_state()); the next size is h clip(0.9 err^(-1/3),
// 0.2, 6), after two rejections by the order estimated from them. A step that fails is shortened, to kShortestShare of
// minimum_step; there a step is accepted and reported whose error is below kGrossShare.
// Once substep_budget is used up, the rest of the interval is reported and goes on at looser tolerances: for another
// budget at the larger of 10 rtol and kSoundShare, for a third one at ten times that, in steps of at most a tenth of
// what was left, then in ten steps whose error is below kGrossShare. Without such a step, or after four budgets, the
// interval ends unfinished (is_impossible).
//
// A state that is soft at the beginning of a step (StiffSystem::soft_states()) is advanced in its measure w, in the
// form
//   v = y_0 + (w(y) - w(y_0))/w'(y_0),   v' = f w'(y)/w'(y_0)                                                (5)
// whose error and slopes at the beginning are those of y, but for w''/w' f on the diagonal of J.
//
// Sources: K. Gustafsson 1994, ACM Trans. Math. Softw. 20, 496 (rejections); A. Sandu et al. 1997, Atmos. Environ. 31,
// 3459 (RODAS3); form (1) as in Hairer and Wanner 1996, IV.7. M = I unless set_mass() makes rows algebraic: the method
// is stiffly accurate, so they need no further treatment. A step ends where the system expects a bend
// (StiffSystem::time_to_bend()); the size before it is kept for the next. The step size is carried over from one
// interval to the next and is part of the state. Real-time safe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "math/stage_matrix.h"
#include "math/stiff_system.h"

namespace slew::math {

class Rodas3 final : public StiffIntegrator {
 public:
  Rodas3(const SparsityPattern& pattern, std::size_t jacobian_stride, StiffOptions options);

  StiffReport advance(StiffSystem& system, std::span<double> y, double duration) noexcept override;
  void restart() noexcept override { step_size_ = 0; }
  [[nodiscard]] double step_size() const noexcept override { return step_size_; }
  void set_step_size(double h) noexcept override { step_size_ = h; }
  void save(StateWriter& bytes) const override { bytes.number(step_size_); }
  void load(StateReader& bytes) noexcept override { bytes.number(step_size_); }
  [[nodiscard]] double integral(const StateFunction& g, std::size_t state, double h, const double* y_before,
                                const double* f_before, const double* y) const noexcept override;
  [[nodiscard]] bool takes_algebraic_rows() const noexcept override { return true; }
  void set_mass(std::span<const double> mass) noexcept override { matrix_.set_mass(mass); }

 private:
  // A state in its measure, (5), at the beginning of the step and at the stages.
  struct Soft {
    std::size_t state;
    double y, w, slope;
    double stage_3, stage_4;  // y at (2)
  };
  [[nodiscard]] const double* find_soft(const StiffSystem& system, const double* y, const double* J) noexcept;
  [[nodiscard]] const double* to_states(const StiffSystem& system, const double* v) noexcept;
  void to_soft_rates(const StiffSystem& system, const double* y, double* f) const noexcept;
  [[nodiscard]] std::int32_t first_non_finite() const noexcept;
  [[nodiscard]] double allowed_error(std::uint32_t tries) const noexcept;
  // Largest errors of the last step from y, 1 = tolerance.
  struct Errors {
    double stored = 0;  // of states that are not algebraic: the error of those may be their jump
    double kept = 0;    // of these, states that are not replaced after the interval
  };
  [[nodiscard]] Errors errors(const double* y) const noexcept;
  [[nodiscard]] double next_step(double wanted_before, double used, double factor, double longest) const noexcept;
  [[nodiscard]] double try_step(StiffSystem& system, const double* y, double h) noexcept;

  std::size_t size_;
  StiffOptions options_;
  StageMatrix matrix_;
  std::int32_t worst_ = -1;  // worst state of the last step tried
  double step_size_ = 0;
  std::vector<double> f_, k1_, k2_, k3_, k4_, stage_, new_;
  std::size_t stride_;
  std::vector<Soft> soft_;  // reserved for all states
  std::vector<std::size_t> soft_states_;
  std::vector<double> states_, soft_J_;  // y of a stage; J in the variables of (5)
};

}  // namespace slew::math
