// SPDX-License-Identifier: Apache-2.0
// SUNDIALS CVODE (variable-order BDF, Newton with the system's own Jacobian, dense LU) as a StiffIntegrator.
//
// Keeps its history over intervals while the motion is smooth: restarting every interval costs ten times the accuracy.
// Restarts after inputs_jumped(), and if the caller moved w(y) by more than 1e-3 of a state's size since the last
// interval ended. Smaller moves (position corrections of a coupling) become an offset: with
//   w(y) = z + o,   z' = w'(y) f(y),   o <- o + (w(y_given) - w(y_reached))                                  (1)
// z is continuous, and the error test judges the small remaining jump in z'. w is the measure of a state that has one
// (stiff_system.h), else the state: BDF keeps linear sums of z to rounding, at any tolerance. Errors of w per step are
// held below rtol (s_i + r_i |y_i|), root mean square. Each interval ends exactly, by CVODE's stop time.
//
// The same calls give the same bits. Source: Hindmarsh et al. 2005, ACM TOMS 31, 363. Memory is taken at build; the
// cost of an interval is not bounded in a useful way (100 000 steps): for reference runs, not for real time.
#pragma once

#include <memory>

#include "math/stiff_system.h"

namespace slew::math {

class CvodeStepper final : public StiffIntegrator {
 public:
  CvodeStepper(std::size_t jacobian_stride, StiffOptions options);
  ~CvodeStepper() override;
  CvodeStepper(const CvodeStepper&) = delete;
  CvodeStepper& operator=(const CvodeStepper&) = delete;

  // accepted: CVODE's steps; rejected: its error-test failures.
  StiffReport advance(StiffSystem& system, std::span<double> y, double duration) noexcept override;
  void inputs_jumped() noexcept override { has_history_ = false; }
  void restart() noexcept override { has_history_ = false; }
  [[nodiscard]] double step_size() const noexcept override;
  void set_step_size(double) noexcept override {}
  [[nodiscard]] bool can_save() const noexcept override { return false; }
  // Time since the restart, the offset o, step sizes, order, and the derivatives of z up to it.
  void add_to(StateHash& hash) const noexcept override;

 private:
  struct Memory;

  void begin_at(std::span<const double> y, StiffReport& report) noexcept;
  void take_along(std::span<const double> y, StiffReport& report) noexcept;
  [[nodiscard]] bool take_move(std::span<const double> before, std::span<const double> after) noexcept;
  [[nodiscard]] std::int32_t worst_state() const noexcept;

  StiffOptions options_;
  std::unique_ptr<Memory> memory_;
  bool has_history_ = false;
  double t_ = 0;                 // s, since the restart
  std::vector<double> reached_;  // y at the end of the last interval
  std::vector<double> f_, new_, given_, moved_;
};

}  // namespace slew::math
