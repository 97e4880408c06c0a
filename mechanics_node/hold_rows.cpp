// SPDX-License-Identifier: Apache-2.0
// Rows whose laws hold them within a sub-step of rk4, with modes or springs behind them: what the stages need to
// correct the forces of the port problem (multibody/formulations/row_hold.h).
#include <algorithm>

#include "math/small_solve.h"
#include "mechanics_node/port_problem.h"

namespace slew::mechanics_node {
namespace {

// h/2 c W of a law's slope c from which on rows are held. Below, a late force makes no modes grow (at 0.5 and less, of
// any number of modes to the bound of rk4), and the correction is of the third order.
constexpr double kHolds = 0.05;

}  // namespace

// The row's law after the port problem, moved on by a change of its speed over the half sub-step. Of friction and stops
// alone: the pressure force stays, since the partner receives its work as the port problem found it.
coupling::RowForce PortProblem::law_at_end(std::size_t k, double speed_change) const noexcept {
  const double pressure_force = is_port(active_[k]) ? ports_[active_[k]].F : 0.0;
  const double x = dynamics_end_x_[k] + 0.5 * hold_.length * speed_change;
  return laws_.evaluate(k, pressure_force, x, dynamics_end_v_[k] + speed_change);
}

double PortProblem::change(std::size_t row, double speed_change) const noexcept {
  const std::size_t k = place_[row];
  const double ratio = ratio_of(row);
  return ratio * (law_at_end(k, ratio * speed_change).force - held_force_[k]);
}

// Slope between the speeds of its beginning and its end: of dry friction that turns round on the way, and is flat at
// both; at least 0.
double PortProblem::slope_over_substep(std::size_t k, double force) const noexcept {
  const double change = dynamics_end_v_[k] - v_begin_[k];
  return change != 0 ? std::max(0.0, (law_at_end(k, -change).force - force) / change) : 0.0;
}

// Slopes of the laws, by row. False: none holds its row.
bool PortProblem::find_slopes(double h) noexcept {
  const std::size_t rows = mechanism_.row_count();
  const std::span<const double> W = multibody::row_mobility(mechanism_.workspace());
  std::fill(hold_.law_slope.begin(), hold_.law_slope.end(), 0.0);
  std::copy(dynamics_.x().begin(), dynamics_.x().end(), dynamics_end_x_.begin());
  std::copy(dynamics_.v().begin(), dynamics_.v().end(), dynamics_end_v_.begin());
  laws_.set_interval(0.5 * h);
  bool holds = false;
  for (std::size_t k = 0; k < active_.size(); ++k) {
    const std::size_t row = active_[k];
    const coupling::RowForce law = law_at_end(k, 0);
    const double ratio = ratio_of(row);
    place_[row] = k;
    held_force_[k] = law.force;
    hold_.law_slope[row] = ratio * ratio * std::max(-(law.d_v + 0.5 * h * law.d_x), slope_over_substep(k, law.force));
    hold_.half_mobility[row] = 0.5 * h * W[row * rows + row];
    holds = holds || hold_.law_slope[row] * hold_.half_mobility[row] > kHolds;
  }
  return holds;
}

// G of (1) there. False: no such matrix.
bool PortProblem::find_gain(double h) noexcept {
  const std::size_t rows = mechanism_.row_count();
  const std::span<const double> W = multibody::row_mobility(mechanism_.workspace());
  for (std::size_t k = 0; k < rows; ++k) {
    const double half = 0.5 * h * hold_.law_slope[k];
    for (std::size_t j = 0; j < rows; ++j) {
      held_matrix_[k * rows + j] = (k == j ? 1.0 : 0.0) + half * W[k * rows + j];
      hold_.gain[k * rows + j] = k == j ? half : 0.0;
    }
  }
  return math::solve_in_place(held_matrix_.data(), hold_.gain.data(), rows, rows);
}

// After the solution of the port problem; null: no row is held.
multibody::RowHold* PortProblem::hold_rows(double h) noexcept {
  if (!mobility_.springs_answer_within_substep()) return nullptr;
  hold_.start = mechanism_.state().time;
  hold_.length = h;
  if (!find_slopes(h) || !find_gain(h)) return nullptr;
  const std::size_t m = active_.size();
  for (std::size_t k = 0; k < m; ++k) {
    const std::size_t row = active_[k];
    const double* W = dynamics_.W().data() + k * m;
    double mean = dynamics_.a_free()[k] + 0.5 * h * dynamics_.a_free_rate()[k], slope = dynamics_.a_free_rate()[k];
    for (std::size_t j = 0; j < m; ++j) {
      mean += W[j] * dynamics_.f_mean()[j];
      slope += W[j] * dynamics_.f_slope()[j];
    }
    hold_.mean[row] = mean / ratio_of(row);
    hold_.slope[row] = slope / ratio_of(row);
  }
  return &hold_;
}

}  // namespace slew::mechanics_node
