// SPDX-License-Identifier: Apache-2.0
#include "math/rodas3.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/check.h"

namespace slew::math {
namespace {

constexpr double kGamma = 0.5;
constexpr double kC21 = 4, kC31 = 1, kC32 = -1, kC41 = 1, kC42 = -1, kC43 = -8.0 / 3;
constexpr double kSafety = 0.9;  // factor on the size that the error estimate just allows
constexpr double kShrink = 0.2;  // bounds on the change of the step size from one step to the next
constexpr double kGrow = 6;
constexpr double kFirstFraction = 0.1;       // share of the interval, for the first step
constexpr double kStretch = 1e-9;            // relative: a rest this small is taken with the step before it
constexpr std::uint32_t kLooserBudgets = 2;  // budgets after the first one, each at a tolerance looser by kLooser
constexpr double kLooser = 10;
constexpr int kLastSteps = 10;             // steps for the rest of an interval after these budgets
constexpr std::uint32_t kMostBudgets = 4;  // tries of an interval, over the budget: some for steps of gross error
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kLowestOrder = 0.1;  // lower bound of the order estimated from two rejections

// A step that was not accepted.
struct Rejected {
  double h = 0, error = 0;  // s; 0: none
};

// Step size after a second rejection: in a very stiff transient the error falls far slower than h^3. Its order k
// follows from both rejections (Gustafsson 1994), and the next size is h err^(-1/k).
double shorter(const Rejected& before, const Rejected& now, double factor) noexcept {
  if (!(before.h > now.h) || !(before.error < kInfinity) || !(now.error < kInfinity)) return factor;
  const double order = std::log(before.error / now.error) / std::log(before.h / now.h);
  if (order >= 3) return factor;
  return std::clamp(kSafety * std::pow(now.error, -1 / std::max(order, kLowestOrder)), kShrink, factor);
}

}  // namespace

Rodas3::Rodas3(const SparsityPattern& pattern, std::size_t jacobian_stride, StiffOptions options)
    : size_(pattern.size()),
      options_(std::move(options)),
      matrix_(pattern, jacobian_stride),
      f_(size_),
      k1_(size_),
      k2_(size_),
      k3_(size_),
      k4_(size_),
      stage_(size_),
      new_(size_),
      stride_(jacobian_stride),
      soft_states_(size_),
      states_(size_),
      soft_J_(size_ * jacobian_stride) {
  SLEW_CHECK(options_.scale.size() == size_ && options_.relative.size() == size_);
  soft_.reserve(size_);
}

// Takes the soft states at y; J in the variables of (5).
const double* Rodas3::find_soft(const StiffSystem& system, const double* y, const double* J) noexcept {
  soft_.clear();
  const std::size_t count = system.soft_states(y, soft_states_);
  if (count == 0) return J;
  std::copy(J, J + size_ * stride_, soft_J_.begin());
  for (const std::size_t i : std::span(soft_states_).first(count)) {
    const StiffSystem::Measure w = system.measure(i, y[i]);
    soft_J_[i * stride_ + i] += w.bend / w.slope * f_[i];
    soft_.push_back({i, y[i], w.value, w.slope, y[i], y[i]});
  }
  return soft_J_.data();
}

// (5) solved for y
const double* Rodas3::to_states(const StiffSystem& system, const double* v) noexcept {
  if (soft_.empty()) return v;
  std::copy(v, v + size_, states_.begin());
  for (const Soft& soft : soft_) {
    states_[soft.state] = system.state_of_measure(soft.state, soft.w + soft.slope * (v[soft.state] - soft.y));
  }
  return states_.data();
}

void Rodas3::to_soft_rates(const StiffSystem& system, const double* y, double* f) const noexcept {
  for (const Soft& soft : soft_) f[soft.state] *= system.measure(soft.state, y[soft.state]).slope / soft.slope;
}

// Stages (2) and the new state (4) into new_; returns the error measure, infinite when it is not a number.
double Rodas3::try_step(StiffSystem& system, const double* y, double h) noexcept {
  const std::size_t n = size_;
  const double c = 1 / h;
  const std::vector<double>& M = matrix_.mass();
  std::copy(f_.begin(), f_.end(), k1_.begin());
  matrix_.solve(k1_);
  for (std::size_t i = 0; i < n; ++i) k2_[i] = f_[i] + M[i] * (c * kC21 * k1_[i]);
  matrix_.solve(k2_);

  for (std::size_t i = 0; i < n; ++i) stage_[i] = y[i] + 2 * k1_[i];
  const double* at = to_states(system, stage_.data());
  for (Soft& soft : soft_) soft.stage_3 = at[soft.state];
  system.derivative(at, k3_.data());
  to_soft_rates(system, at, k3_.data());
  for (std::size_t i = 0; i < n; ++i) k3_[i] += M[i] * (c * (kC31 * k1_[i] + kC32 * k2_[i]));
  matrix_.solve(k3_);

  for (std::size_t i = 0; i < n; ++i) stage_[i] += k3_[i];
  at = to_states(system, stage_.data());
  for (Soft& soft : soft_) soft.stage_4 = at[soft.state];
  system.derivative(at, k4_.data());
  to_soft_rates(system, at, k4_.data());
  for (std::size_t i = 0; i < n; ++i) {
    k4_[i] += M[i] * (c * (kC41 * k1_[i] + kC42 * k2_[i] + kC43 * k3_[i]));
  }
  matrix_.solve(k4_);

  double error = 0;
  bool is_number = true;
  worst_ = -1;
  for (std::size_t i = 0; i < n; ++i) {
    new_[i] = stage_[i] + k4_[i];
    const double size = options_.size_of(i, y[i]);
    const double e = std::fabs(k4_[i]) / (options_.relative_tolerance * size);
    is_number = is_number && e <= std::numeric_limits<double>::max();
    if (e > error) {
      error = e;
      worst_ = static_cast<std::int32_t>(i);
    }
  }
  if (!soft_.empty()) {
    at = to_states(system, new_.data());
    for (const Soft& soft : soft_) new_[soft.state] = at[soft.state];
  }
  return is_number ? error : kInfinity;
}

// (1) for w' = g(y_i), whose row of J is g' at the start in column i: with q the K of w,
//   q_s = h gamma (g(stage_s) + g' K_s) + gamma sum_j c_sj q_j
double Rodas3::integral(const StateFunction& g, std::size_t state, double h, const double* before, const double*,
                        const double*) const noexcept {
  const auto [g_1, slope] = g.at(before[state]);
  const double k1 = slope * k1_[state], k2 = slope * k2_[state], k3 = slope * k3_[state], k4 = slope * k4_[state];
  double y3 = before[state] + 2 * k1_[state], y4 = y3 + k3_[state];
  const auto soft = std::find_if(soft_.begin(), soft_.end(), [state](const Soft& one) { return one.state == state; });
  if (soft != soft_.end()) y3 = soft->stage_3, y4 = soft->stage_4;
  const double weight = h * kGamma;
  const double q1 = weight * (g_1 + k1);
  const double q2 = weight * (g_1 + k2) + kGamma * kC21 * q1;
  const double q3 = weight * (g.at(y3).value + k3) + kGamma * (kC31 * q1 + kC32 * q2);
  const double q4 = weight * (g.at(y4).value + k4) + kGamma * (kC41 * q1 + kC42 * q2 + kC43 * q3);
  return 2 * q1 + q3 + q4;
}

// First non-finite state: in the derivative at the step's start, else in the new state.
std::int32_t Rodas3::first_non_finite() const noexcept {
  for (std::size_t i = 0; i < size_; ++i) {
    if (!std::isfinite(f_[i])) return static_cast<std::int32_t>(i);
  }
  for (std::size_t i = 0; i < size_; ++i) {
    if (!std::isfinite(new_[i])) return static_cast<std::int32_t>(i);
  }
  return -1;
}

// Error that a step may have, 1 = tolerance, after so many tries in an interval.
double Rodas3::allowed_error(std::uint32_t tries) const noexcept {
  const std::uint32_t budgets = std::min(tries / options_.substep_budget, kLooserBudgets + 1);
  if (budgets == 0) return 1;
  const double gross = std::max(1.0, kGrossShare / options_.relative_tolerance);
  double allowed = std::max(kLooser, kSoundShare / options_.relative_tolerance);
  for (std::uint32_t k = 1; k < budgets; ++k) allowed *= kLooser;
  return budgets > kLooserBudgets ? gross : std::min(allowed, gross);
}

Rodas3::Errors Rodas3::errors(const double* y) const noexcept {
  Errors largest;
  for (std::size_t i = 0; i < size_; ++i) {
    if (matrix_.mass()[i] == 0) continue;
    const double error = std::fabs(k4_[i]) / (options_.relative_tolerance * options_.size_of(i, y[i]));
    largest.stored = std::max(largest.stored, error);
    if (options_.keeps_error(i)) largest.kept = std::max(largest.kept, error);
  }
  return largest;
}

// A step cut short by the end of the interval does not shorten the next one. Below minimum_step the size only grows.
double Rodas3::next_step(double wanted_before, double used, double factor, double longest) const noexcept {
  const double wanted = factor >= 1 ? std::max(wanted_before, used * factor) : used * factor;
  return std::min(std::max(wanted, std::min(options_.minimum_step, wanted_before)), longest);
}

StiffReport Rodas3::advance(StiffSystem& system, std::span<double> y, double duration) noexcept {
  SLEW_ASSERT(y.size() == size_);
  StiffReport report;
  double h = step_size_ > 0 ? step_size_ : kFirstFraction * duration;
  double rest = duration, longest = duration;
  bool is_last = false;
  const double shortest = kShortestShare * options_.minimum_step;
  const double* J = nullptr;
  Rejected rejected;
  while (rest > 0) {
    const std::uint32_t tries = report.accepted + report.rejected;
    const double allowed = allowed_error(tries);
    // budget used up: no step longer than a tenth of the rest
    if (!report.is_over_budget && tries >= options_.substep_budget) {
      report.is_over_budget = true;
      longest = std::max(options_.minimum_step, rest / kLastSteps);
      h = std::min(h, longest);
    }
    // all of them: a few more steps, with any error that is not gross
    if (!is_last && tries >= (1 + kLooserBudgets) * options_.substep_budget) {
      is_last = true;
      h = longest = std::max(options_.minimum_step, rest / kLastSteps);
    }
    // two equal steps rather than a long and a short one
    const bool reaches_end = h >= rest * (1 - kStretch);
    double used = reaches_end ? rest : std::min(h, std::max(0.5 * rest, options_.minimum_step));
    if (J == nullptr) J = find_soft(system, y.data(), system.linearise(y.data(), f_.data()));
    const double bend = system.time_to_bend(y.data(), f_.data(), J);
    const bool ends_at_bend = bend < used && bend > options_.minimum_step && !report.is_over_budget;
    if (ends_at_bend) used = bend;
    const bool is_solvable = matrix_.factorise(J, 1 / (used * kGamma));
    if (matrix_.is_dense()) ++report.dense_factorisations;
    double error = is_solvable ? try_step(system, y.data(), used) : kInfinity;
    // where a law turns from stiff to soft the estimate takes a stage far beyond the end of the motion for the end
    const std::int32_t impossible = error < kInfinity ? system.impossible_state(used, y.data(), new_.data()) : -1;
    if (impossible >= 0) error = kInfinity;
    const double factor = std::clamp(kSafety / std::cbrt(std::max(error / allowed, 1e-12)), kShrink, kGrow);

    const bool is_shortest = used <= shortest;
    const Errors above = error > 1 && error < kInfinity ? errors(y.data()) : Errors{};
    const bool is_gross = above.stored * options_.relative_tolerance > kGrossShare;
    const bool is_accepted = error <= allowed || (error < kInfinity && !is_gross && (is_shortest || is_last));
    if (!is_accepted) {
      if (is_shortest || tries >= kMostBudgets * options_.substep_budget) {
        report.is_finite = impossible >= 0 || error < kInfinity;
        report.is_impossible = report.is_finite;
        report.worst_state = impossible >= 0 ? impossible : report.is_finite ? worst_ : first_non_finite();
        return report;
      }
      ++report.rejected;
      h = std::max(shortest, used * std::min(shorter(rejected, {used, error / allowed}, factor), 0.9));
      rejected = {used, error / allowed};
      continue;
    }
    if (error > 1 && is_shortest) report.is_at_minimum_step = true;
    if (error > report.largest_error) {
      report.largest_error = error;
      report.worst_state = worst_;
    }
    if (above.kept > 1 && above.kept * options_.relative_tolerance > kSoundShare) {
      report.accepted_error += above.kept * options_.relative_tolerance;
    }
    ++report.accepted;
    system.accepted(used, y.data(), f_.data(), new_.data());
    std::copy(new_.begin(), new_.end(), y.begin());
    J = nullptr;
    rejected = {};
    rest = reaches_end && !ends_at_bend ? 0 : rest - used;
    // after a bend the step size before it is tried again
    if (is_last) {
      h = std::min(kGrow * used, longest);
    } else if (!ends_at_bend) {
      h = next_step(h, used, factor, longest);
    }
  }
  step_size_ = report.is_over_budget ? options_.minimum_step : h;
  return report;
}

}  // namespace slew::math
