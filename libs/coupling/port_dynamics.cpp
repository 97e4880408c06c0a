// SPDX-License-Identifier: Apache-2.0
#include "coupling/port_dynamics.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/check.h"
#include "core/reductions.h"
#include "math/fixed_size.h"
#include "math/small_solve.h"

namespace slew::coupling {
namespace {

// instants of the stages' forces in a step that make mean and slope of a force linear in time exact:
// (1 - gamma)(1 - t_1) gamma + gamma (1 - t_2) = 1/6 and (1 - gamma)(1 - t_1) + gamma (1 - t_2) = 1/2
constexpr double kFirstOfLine = 1.0 / 3;
constexpr double kEndOfLine = 0.90236892706218252;
// 1/3 - 2 gamma (1 - gamma)^2: moment of a force t over a step that the instants of the displacement leave out
constexpr double kLeftOut = 0.04044011451988;

// damping over mass, times the micro-step, from which a speed decays within it
constexpr double kDecay = 1;

// A piecewise linear law needs one iteration per crossed kink. The rest is for bisections when two rows reach a jump at
// once.
constexpr int kMaxIterations = 80;
// iteration from which the speed with the widest step is bracketed by its last two values with steps to either side;
// this ends cycles by narrow steep parts of a law, such as friction about rest
constexpr int kBracketedAfter = 12;
// Width of a bracket, in speed scales, below which it holds a jump of its law, such as a stop's damping at first touch:
// no speed has a matching force, so the force is taken between those of the two sides.
constexpr double kJumpWidth = 1e-9;
constexpr double kNarrow = 1e-3;  // share of the step that leads out of the bracket
// speeds are converged below this fraction of the speed scale: well under any physical resolution, above round-off
constexpr double kRelativeTolerance = 1e-12;
constexpr double kAbsoluteTolerance = 1e-15;

// rows of a crane with all its limits: their number is a constant in the iteration
constexpr std::size_t kMostFixed = 6;

// limit of the parts of micro-steps in a solve; beyond it, the rest of a micro-step is one part
constexpr int kMostTries = 512;

}  // namespace

PortDynamics::PortDynamics(std::size_t capacity) : capacity_(capacity), rows_(capacity) {
  for (std::vector<double>* values :
       {&x_,        &v_,      &z_,       &a_free_,  &a_free_rate_,   &weighted_a_, &shrink_,    &drive_,
        &pull_,     &x_base_, &v_base_,  &z_base_,  &x_stage_,       &v_stage_,    &z_stage_,   &pressure_force_,
        &f_,        &slope_,  &f_mean_,  &f_slope_, &displacing_,    &f_settled_,  &work_,      &impulse_,
        &residual_, &low_,    &high_,    &f_low_,   &f_held_,        &f_high_,     &last_step_, &k_x_,
        &k_v_,      &k_z_,    &v_first_, &f_first_, &pressure_first_}) {
    values->assign(capacity, 0.0);
  }
  for (std::vector<RowForce>* laws : {&law_, &law_first_, &law_start_}) laws->assign(capacity, RowForce{});
  W_.assign(capacity * capacity, 0.0);
  weighted_W_.assign(capacity * capacity, 0.0);
  A_.assign(capacity * capacity, 0.0);
  K_between_.assign(capacity * capacity, 0.0);
  pull_between_.assign(capacity * capacity, 0.0);
  is_at_jump_.assign(capacity, 0);
  jump_first_.assign(capacity, 0);
  decays_.assign(capacity, 0);
  partner_.assign(capacity, RowPartner{});
}

void PortDynamics::set_rows(std::size_t rows) noexcept {
  SLEW_CHECK(rows <= capacity_);
  rows_ = rows;
  is_coupled_ = false;
}

std::span<double> PortDynamics::couple() noexcept {
  is_coupled_ = true;
  std::fill_n(K_between_.begin(), rows_ * rows_, 0.0);
  return {K_between_.data(), rows_ * rows_};
}

// terms common to the stages of one solve
void PortDynamics::prepare(double weight) noexcept {
  for (std::size_t i = 0; i < rows_; ++i) {
    const RowPartner& p = partner_[i];
    shrink_[i] = 1 / (1 + weight * p.lambda);
    drive_[i] = weight * (p.F_dot + p.K * p.v_ref + p.lambda * p.F_n) * shrink_[i];
    pull_[i] = weight * p.K * shrink_[i];
  }
  for (std::size_t i = 0; i < rows_ * rows_; ++i) weighted_W_[i] = weight * W_[i];
  if (!is_coupled_) return;
  for (std::size_t i = 0; i < rows_; ++i) {
    for (std::size_t j = 0; j < rows_; ++j) {
      const double pull = weight * K_between_[i * rows_ + j] * shrink_[i];
      pull_between_[i * rows_ + j] = pull;
      drive_[i] += pull * partner_[j].v_ref;
    }
  }
}

// stage values x, z from the stage speeds, then force f and its total slope with respect to the own speed
template <typename Rows>
void PortDynamics::evaluate_rows(Rows rows, double weight, const RowLaws& laws) noexcept {
  for (std::size_t i = 0; i < rows; ++i) {
    const RowPartner& p = partner_[i];
    x_stage_[i] = x_base_[i] + weight * v_stage_[i];
    z_stage_[i] = (shrink_[i] * z_base_[i] + drive_[i]) - pull_[i] * v_stage_[i];
    pressure_force_[i] = z_stage_[i] - p.D * (v_stage_[i] - p.v_ref);
  }
  if (is_coupled_) pull_by_others();
  laws.evaluate_all(rows, pressure_force_.data(), x_stage_.data(), v_stage_.data(), law_.data());
  for (std::size_t i = 0; i < rows; ++i) {
    const RowForce& law = law_[i];
    f_[i] = law.force;
    slope_[i] = law.d_v + weight * law.d_x - law.d_z * (pull_[i] + partner_[i].D);
    if (is_at_jump_[i] != 0) {
      slope_[i] = (f_high_[i] - f_low_[i]) / (high_[i] - low_[i]);
      f_[i] = f_held_[i];
    }
  }
}

void PortDynamics::pull_by_others() noexcept {
  for (std::size_t i = 0; i < rows_; ++i) {
    double pull = 0;
    for (std::size_t j = 0; j < rows_; ++j) pull += pull_between_[i * rows_ + j] * v_stage_[j];
    z_stage_[i] -= pull;
    pressure_force_[i] -= pull;
  }
}

void PortDynamics::forget_bracket(std::size_t row) noexcept {
  low_[row] = -kUnbounded;
  high_[row] = kUnbounded;
  last_step_[row] = kUnbounded;
  is_at_jump_[row] = 0;
}

// Moves the bracket: the solution lies beyond the present speed, in the direction of the step. False if the bracket is
// wrong because other rows moved.
bool PortDynamics::note_side(std::size_t row, double step) noexcept {
  if (is_at_jump_[row] != 0) return true;
  (step > 0 ? low_ : high_)[row] = v_stage_[row];
  (step > 0 ? f_low_ : f_high_)[row] = f_[row];
  if (low_[row] <= high_[row]) return true;
  forget_bracket(row);
  return false;
}

// The stage speed after a Newton step that must not leave the bracket and must be at most half as long as the one
// before; the bracket is halved otherwise.
double PortDynamics::bracketed(std::size_t row, double step, double sway, double narrow) noexcept {
  const double low = low_[row], high = high_[row], next = v_stage_[row] + step;
  const bool is_inside = low < next && next < high;
  if (is_at_jump_[row] != 0) {
    // by the step itself: the speed has too few digits to separate forces in so narrow a bracket
    f_held_[row] += slope_[row] * step;
    const auto [least, most] = std::minmax(f_low_[row], f_high_[row]);
    if (!(least <= f_held_[row] && f_held_[row] <= most)) forget_bracket(row);
    return next;
  }
  // so narrow a bracket holds a jump that the step comes from, or is wrong because other rows moved
  if (high - low < kNarrow * std::fabs(step) && sway * std::fabs(f_low_[row] - f_high_[row]) < 0.5 * std::fabs(step)) {
    forget_bracket(row);
    return next;
  }
  const double half = 0.5 * (high - low);
  // a step too short to move the speed lies on an edge
  if (!std::isfinite(half) || next == v_stage_[row] || (is_inside && std::fabs(step) <= 0.5 * last_step_[row])) {
    last_step_[row] = std::fabs(step);
    return next;
  }
  is_at_jump_[row] = low < high && high - low <= narrow ? 1 : 0;
  f_held_[row] = 0.5 * (f_low_[row] + f_high_[row]);
  last_step_[row] = half;
  return low + half;
}

// the part of A by which the forces of coupled rows follow the speeds of the others
void PortDynamics::add_coupled_slopes() noexcept {
  const std::size_t m = rows_;
  for (std::size_t k = 0; k < m; ++k) {
    if (is_at_jump_[k] != 0) continue;
    for (std::size_t j = 0; j < m; ++j) {
      const double slope = law_[k].d_z * pull_between_[k * m + j];
      for (std::size_t i = 0; i < m && slope != 0; ++i) A_[i * m + j] += weighted_W_[i * m + k] * slope;
    }
  }
}

// v = v_base + weight (a_free + time a_free' + W f(v)) for the stage speeds
template <typename Rows>
bool PortDynamics::solve_stage_of(Rows rows, double weight, double time, const RowLaws& laws,
                                  PortStep& report) noexcept {
  const std::size_t m = rows;
  largest_a_ = 0;
  for (std::size_t i = 0; i < m; ++i) {
    forget_bracket(i);
    weighted_a_[i] = weight * (a_free_[i] + time * a_free_rate_[i]);
    largest_a_ = std::max(largest_a_, std::fabs(weighted_a_[i]));
  }
  for (int iteration = 0;; ++iteration) {
    evaluate_rows(rows, weight, laws);
    double scale = largest_a_;
    for (std::size_t i = 0; i < m; ++i) {
      double gain = weighted_a_[i];
      for (std::size_t j = 0; j < m; ++j) gain += weighted_W_[i * m + j] * f_[j];
      residual_[i] = v_base_[i] + gain - v_stage_[i];
      scale = std::max(scale, std::fabs(v_stage_[i]));
    }
    const double largest = fixed_max_abs({residual_.data(), m});
    ++report.iterations;
    const bool has_converged = largest <= kAbsoluteTolerance + kRelativeTolerance * scale;
    bool is_over = has_converged || iteration == kMaxIterations || std::isnan(largest);
    if (!is_over) {
      for (std::size_t i = 0; i < m; ++i) {
        for (std::size_t j = 0; j < m; ++j) A_[i * m + j] = (i == j ? 1.0 : 0.0) - weighted_W_[i * m + j] * slope_[j];
      }
      if (is_coupled_) add_coupled_slopes();
      is_over = !math::solve_in_place(A_.data(), residual_.data(), m, 1);
    }
    if (is_over) {
      if (!(largest <= report.residual)) report.residual = largest;
      return has_converged;
    }
    if (iteration < kBracketedAfter) {
      for (std::size_t i = 0; i < m; ++i) v_stage_[i] += residual_[i];
      continue;
    }
    std::size_t widest = 0;
    for (std::size_t i = 1; i < m; ++i) {
      if (std::fabs(residual_[i]) > std::fabs(residual_[widest])) widest = i;
    }
    for (std::size_t i = 0; i < m; ++i) {
      const double step = residual_[i];
      const bool is_known = note_side(i, step);
      // the change for the widest step must not move the other rows out of their brackets
      const bool is_thrown = is_known && std::isfinite(high_[i] - low_[i]) &&
                             !(low_[i] < v_stage_[i] + step && v_stage_[i] + step < high_[i]);
      if (is_at_jump_[i] != 0 || is_thrown || (is_known && i == widest)) {
        v_stage_[i] = bracketed(i, step, weighted_W_[i * m + i], kJumpWidth * scale);
      } else {
        v_stage_[i] += i == widest ? 0.5 * step : step;
      }
    }
  }
}

bool PortDynamics::solve_stage(double weight, double time, const RowLaws& laws, PortStep& report) noexcept {
  return math::with_fixed_size<kMostFixed>(rows_,
                                           [&](auto rows) { return solve_stage_of(rows, weight, time, laws, report); });
}

void PortDynamics::set_weight(double weight, RowLaws& laws) noexcept {
  prepare(weight);
  laws.set_interval(weight);
}

void PortDynamics::keep_first() noexcept {
  for (std::size_t i = 0; i < rows_; ++i) {
    v_first_[i] = v_stage_[i];
    f_first_[i] = f_[i];
    pressure_first_[i] = pressure_force_[i];
    law_first_[i] = law_[i];
    jump_first_[i] = is_at_jump_[i];
  }
}

void PortDynamics::add(double share, const Instant& at, std::span<const double> f,
                       std::span<const double> pressure_force, std::span<const double> v) noexcept {
  for (std::size_t i = 0; i < rows_; ++i) {
    const bool has_partner = partner_[i].K != 0 || partner_[i].F_dot != 0;
    const double time = at.is_at_stop ? at.of_displacement : has_partner ? at.of_stage : at.of_line;
    f_mean_[i] += share * f[i];
    f_slope_[i] += share * (time - 0.5 * h_) * f[i];
    displacing_[i] += share * (at.of_displacement - 0.5 * h_) * f[i];
    work_[i] += share * pressure_force[i] * v[i];
    impulse_[i] += share * pressure_force[i];
  }
}

// to the end of the last stage
void PortDynamics::move(PortStep& report) noexcept {
  is_at_stop_ = false;
  for (std::size_t i = 0; i < rows_; ++i) {
    x_[i] = x_stage_[i];
    v_[i] = v_stage_[i];
    z_[i] = z_stage_[i];
    is_at_stop_ = is_at_stop_ || law_[i].stop != 0 || is_at_jump_[i] != 0;
  }
  report.meets_stop = report.meets_stop || is_at_stop_;
}

// Two stages; false, with the state unchanged, if a stop requires a shorter step.
bool PortDynamics::try_stages(const Span& span, RowLaws& laws, PortStep& report) noexcept {
  const double weight = kGamma * span.length, rate = 1 / weight;
  PortStep tried;
  if (has_memory_) laws.keep();
  for (int stage = 0; stage < 2; ++stage) {
    // first stage at gamma delta, second at delta
    const double carried = (1 - kGamma) * span.length;
    for (std::size_t i = 0; i < rows_; ++i) {
      x_base_[i] = stage == 0 ? x_[i] : x_[i] + carried * k_x_[i];
      v_base_[i] = stage == 0 ? v_[i] : v_[i] + carried * k_v_[i];
      z_base_[i] = stage == 0 ? z_[i] : z_[i] + carried * k_z_[i];
      if (stage == 0) v_stage_[i] = v_[i];
    }
    tried.has_converged &= solve_stage(weight, stage == 0 ? span.first : span.end, laws, tried);
    if (stage == 0) keep_first();
    const double share = (stage == 0 ? 1 - kGamma : kGamma) * span.length;
    for (std::size_t i = 0; i < rows_; ++i) {
      k_x_[i] = v_stage_[i];
      k_v_[i] = (v_stage_[i] - v_base_[i]) * rate;
      k_z_[i] = (z_stage_[i] - z_base_[i]) * rate;
      if (has_memory_) laws.carry(i, v_stage_[i], share);
    }
  }
  report.iterations += tried.iterations;
  if (!follows_stops(span, laws)) {
    if (has_memory_) laws.go_back();
    return false;
  }
  report.has_converged &= tried.has_converged;
  if (!(tried.residual <= report.residual)) report.residual = tried.residual;
  const bool is_at_stop = is_at_stop_;
  move(report);
  report.meets_stop = report.meets_stop || is_at_stop;
  const bool all = is_at_stop || is_at_stop_;
  const auto instant = [&](double of_stage, double of_line, double of_displacement) {
    return Instant{of_stage, span.begin + of_line * span.length, span.begin + of_displacement * span.length, all};
  };
  add((1 - kGamma) * span.length, instant(span.first, kFirstOfLine, 1 - 2 * kGamma), f_first_, pressure_first_,
      v_first_);
  add(kGamma * span.length, instant(span.end, kEndOfLine, 1 - kGamma), f_, pressure_force_, v_stage_);
  return true;
}

// after a micro-step of delta in two stages
void PortDynamics::note_decay(int step, double delta) noexcept {
  for (std::size_t i = 0; i < rows_; ++i) {
    const bool decays = law_[i].stop == 0 && -law_[i].d_v * W_[i * rows_ + i] * delta > kDecay;
    decays_[i] = decays && (step == 0 || decays_[i] != 0) ? 1 : 0;
    if (step == 1) f_settled_[i] = f_[i];
  }
}

// Least-squares slope of a line about the middle of the sub-step: integral of f (t - h/2) over h^3 / 12. Where the
// speed decays, the force is a blow at the start and a part that grows from the second to the last micro-step.
double PortDynamics::slope_of(std::size_t row, int micro_steps) const noexcept {
  double moment = f_slope_[row];
  if (micro_steps > 2 && decays_[row] != 0 && partner_[row].K == 0 && partner_[row].F_dot == 0) {
    const double delta = h_ / micro_steps, growth = (f_[row] - f_settled_[row]) / (micro_steps - 2);
    moment = displacing_[row] + kLeftOut * delta * delta * micro_steps * growth;
  }
  return moment * (12 / (h_ * h_ * h_));
}

PortStep PortDynamics::solve(double h, int micro_steps, RowLaws& laws) noexcept {
  PortStep report;
  h_ = h;
  const double delta = h / micro_steps;
  const double weight = kGamma * delta;
  prepare(weight);
  is_at_stop_ = false;
  for (std::size_t i = 0; i < rows_; ++i) {
    f_mean_[i] = f_slope_[i] = displacing_[i] = work_[i] = impulse_[i] = 0;
    is_at_stop_ = is_at_stop_ || laws.is_at_stop(i, x_[i]);
  }
  has_memory_ = laws.begin(weight);
  tries_left_ = kMostTries;
  for (int step = 0; step < micro_steps; ++step) {
    const Span span{step * delta, delta, (step + kGamma) * delta, (step + 1) * delta};
    if (!try_stages(span, laws, report)) take_in_parts(span, laws, report);
    note_decay(step, delta);
  }
  for (std::size_t i = 0; i < rows_; ++i) {
    f_mean_[i] /= h;
    f_slope_[i] = slope_of(i, micro_steps);
  }
  return report;
}

}  // namespace slew::coupling
