// SPDX-License-Identifier: Apache-2.0
// Stiff laws of rows inside a Runge-Kutta sub-step: a correction of their forces stage by stage.
//
// The owner of the rows solves their laws over a sub-step h from the reduced model of its start (dynamics.h), which
// gives the forces f(t) and the accelerations a(t) of the rows, both linear in time. Springs and modes behind the rows
// move during h and change the free accelerations. A law of slope c in the speed answers: under a change e of the
// acceleration that lasts since the start, the speed changes by h/2 (e + W df) about the middle, and
//   df = -h/2 c (e + W df),  so  df = -G e,  G = (1 + h/2 c W)^-1 h/2 c                             (1)
// Every stage of the rule applies (1) to the difference between its rows' accelerations and a(t):
//   u' = u'(f) + M^-1 J^T df,   e = J u'(f) + J' u - a(t)                                           (2)
// with u'(f) under f(t), M^-1 J^T and W those of the start. A law that is exhausted, as dry friction is, gives less
// than its slope: df lies between 0 and what the law gives if nothing else resists,
//   law(x + h/2 dv, v + dv) - law(x, v),   dv = h/2 (e + W df) less the row's own share             (3)
// With h/2 c W large, W G = 1: the rows move as their law does, and the springs and modes behind them swing as those of
// a mechanism that is held there, to the order of the rule. Without (2), the force of a held row is late by up to h
// against the modes and gives them energy. With h/2 c W small, df is of the third order in h. Compared:
// docs/models/multibody_floating_frame.md.
//
// Stiff damping takes the fastest rates out of (2), and what is left is never faster than the free mechanism: the
// bounds of element_speeds.h hold.
// Not covered: implicit rules, whose rows answer over the sub-step (step_rows.h), and semi_implicit_euler, which takes
// all accelerations at the start, as the reduced model does.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace slew::multibody {

// The laws of the rows, at the end of the owner's solution.
class RowLawChange {
 public:
  virtual ~RowLawChange() = default;
  // Change of a row's force by a change of its speed [N or N m], on its own coordinate.
  [[nodiscard]] virtual double change(std::size_t row, double speed_change) const noexcept = 0;
};

class RowHold {
 public:
  // rows, speeds: of the mechanism. Allocates; nothing else does.
  RowHold(std::size_t rows, std::size_t speeds) : rows_(rows), speeds_(speeds) {
    for (std::vector<double>* by_row : {&mean, &slope, &law_slope, &half_mobility, &excess_, &answer_})
      by_row->assign(rows, 0.0);
    gain.assign(rows * rows, 0.0);
    for (std::vector<double>* by_speed : {&gradients_, &columns_}) by_speed->assign(rows * speeds, 0.0);
  }

  // of a sub-step, set by the owner; the other rows are zero
  double start = 0;                    // s, time of its beginning
  double length = 0;                   // h [s]
  std::vector<double> mean, slope;     // a(t) = mean + (t - h/2) slope, by row [m/s2 or rad/s2, the same by s]
  std::vector<double> gain;            // G, rows x rows, row-major [kg or kg m2]
  std::vector<double> law_slope;       // c [N s/m or N m s/rad]; 0: the row is not held
  std::vector<double> half_mobility;   // h/2 W of the row itself
  const RowLawChange* laws = nullptr;  // outlives the sub-step

  // a(t) of a row at a time of the state [s].
  [[nodiscard]] double expected(std::size_t row, double time) const noexcept {
    return mean[row] + (time - start - 0.5 * length) * slope[row];
  }
  // Takes J u' + J' u - a(t) of a row; 0 of an inactive one.
  void set_excess(std::size_t row, double excess) noexcept { excess_[row] = excess; }
  // df by row, after set_excess() of all rows.
  [[nodiscard]] std::span<const double> answer() noexcept;

  // for the rule: J of the stage and M^-1 J^T of the start, rows x speeds; entries outside of a row's path stay zero
  [[nodiscard]] std::span<double> gradient(std::size_t row) noexcept {
    return {gradients_.data() + row * speeds_, speeds_};
  }
  [[nodiscard]] std::span<double> column(std::size_t row) noexcept {
    return {columns_.data() + row * speeds_, speeds_};
  }

 private:
  [[nodiscard]] double limited(std::size_t row, double force) const noexcept;

  std::size_t rows_, speeds_;
  std::vector<double> excess_, answer_, gradients_, columns_;
};

}  // namespace slew::multibody
