// SPDX-License-Identifier: Apache-2.0
#include "math/implicit_euler.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/check.h"

namespace slew::math {
namespace {

constexpr int kMostIterations = 12;  // quadratic from a guess one sub-step away; kinks cost a few more
constexpr double kConverged = 0.1;   // share of the tolerance: the iteration's error stays below the method's

}  // namespace

ImplicitEuler::ImplicitEuler(const SparsityPattern& pattern, std::size_t jacobian_stride, StiffOptions options)
    : size_(pattern.size()),
      options_(std::move(options)),
      matrix_(pattern, jacobian_stride),
      f_(size_),
      new_(size_),
      slope_(size_),
      d_(size_),
      stride_(jacobian_stride),
      grown_(size_),
      storage_(size_),
      measured_J_(size_ * jacobian_stride) {
  SLEW_CHECK(options_.scale.size() == size_ && options_.relative.size() == size_);
}

// Replaces d_, the right-hand side of (2), by the solution.
bool ImplicitEuler::solve(const double* J, double c, StiffReport& report) noexcept {
  const bool is_regular = matrix_.factorise(J, c);
  if (matrix_.is_dense()) ++report.dense_factorisations;
  if (is_regular) matrix_.solve(d_);
  return is_regular;
}

// Changes y_k - y of (2), of states with a measure by (3), whose slope over y_k lacks w''/w'^2 (w(y_k) - w(y)).
const double* ImplicitEuler::stamp_measures(const StiffSystem& system, const double* y, const double* J,
                                            double c) noexcept {
  bool has_any = false;
  for (std::size_t i = 0; i < size_; ++i) {
    grown_[i] = new_[i] - y[i], storage_[i] = 1;
    if (!system.has_measure(i)) continue;
    const StiffSystem::Measure w = system.measure(i, new_[i]);
    grown_[i] = (w.value - system.measure(i, y[i]).value) / w.slope, storage_[i] = w.slope;
    if (!has_any) std::copy(J, J + size_ * stride_, measured_J_.begin());
    has_any = true;
    measured_J_[i * stride_ + i] += c * grown_[i] * w.bend / w.slope;
  }
  return has_any ? measured_J_.data() : J;
}

ImplicitEuler::Newton ImplicitEuler::try_step(StiffSystem& system, const double* y, double h,
                                              StiffReport& report) noexcept {
  Newton newton;
  const double c = 1 / h;
  std::copy(y, y + size_, new_.begin());
  std::copy(f_.begin(), f_.end(), slope_.begin());
  for (int k = 0; k < kMostIterations; ++k) {
    const double* const plain_J =
        k > 0 ? system.linearise(new_.data(), slope_.data()) : system.jacobian(new_.data(), slope_.data());
    const double* const J = stamp_measures(system, y, plain_J, c);
    for (std::size_t i = 0; i < size_; ++i) d_[i] = slope_[i] - matrix_.mass()[i] * (c * grown_[i]);
    newton.is_finite = solve(J, c, report);
    newton.last = 0;
    for (std::size_t i = 0; i < size_; ++i) {
      new_[i] += d_[i];
      const double size = options_.size_of(i, y[i]);
      const double e =
          std::fabs(d_[i]) * std::max(storage_[i], 1.0) / (kConverged * options_.relative_tolerance * size);
      if (!std::isfinite(e)) {
        newton.is_finite = false;
        newton.worst = static_cast<std::int32_t>(i);
        return newton;
      }
      if (e > newton.last) {
        newton.last = e;
        newton.worst = static_cast<std::int32_t>(i);
      }
    }
    newton.has_converged = newton.is_finite && newton.last <= 1;
    if (newton.has_converged || !newton.is_finite) return newton;
  }
  return newton;
}

// Newton's last correction as a share of a state's size.
double ImplicitEuler::last_correction(const double* y) const noexcept {
  double largest = 0;
  for (std::size_t i = 0; i < size_; ++i) {
    if (matrix_.mass()[i] == 0 || !options_.keeps_error(i)) continue;
    largest = std::max(largest, std::fabs(d_[i]) / options_.size_of(i, y[i]));
  }
  return largest;
}

StiffReport ImplicitEuler::advance(StiffSystem& system, std::span<double> y, double duration) noexcept {
  SLEW_ASSERT(y.size() == size_);
  StiffReport report;
  const double parts = std::max(1.0, std::ceil(duration / options_.maximum_step * (1 - 1e-12)));
  const double nominal = duration / parts;
  const double deepest = kShortestShare * options_.minimum_step;
  for (double part = 0; part < parts; ++part) {
    double rest = nominal, h = nominal;
    while (rest > 0) {
      h = std::min(h, rest);
      system.derivative(y.data(), f_.data());
      const Newton newton = try_step(system, y.data(), h, report);
      const std::int32_t impossible = newton.is_finite ? system.impossible_state(h, y.data(), new_.data()) : -1;
      // the budget bounds the cost of sub-steps below minimum_step
      const double shortest = report.rejected < options_.substep_budget ? deepest : options_.minimum_step;
      const StiffSystem::Unbalanced unbalanced =
          newton.is_finite ? system.unbalanced_state(y.data(), new_.data()) : StiffSystem::Unbalanced{};
      const bool is_sound = newton.has_converged && impossible < 0 && unbalanced.state < 0;
      if (!is_sound && h > shortest) {
        ++report.rejected;
        h = std::max(0.5 * h, shortest);
        continue;
      }
      if (!newton.is_finite || impossible >= 0) {
        report.is_impossible = impossible >= 0;
        report.is_finite = newton.is_finite;
        report.worst_state = report.is_impossible ? impossible : newton.worst;
        return report;
      }
      if (newton.last >= report.largest_error) {
        report.largest_error = newton.last;
        report.worst_state = newton.worst;
      }
      if (unbalanced.state >= 0) report.worst_state = unbalanced.state;
      const double unsolved = newton.has_converged ? 0 : last_correction(y.data());
      const double wrong = std::max(unsolved, unbalanced.share);
      if (!is_sound && wrong > kSoundShare) report.accepted_error += wrong;
      report.is_at_minimum_step = report.is_at_minimum_step || !is_sound;
      ++report.accepted;
      report.is_over_budget = report.rejected > options_.substep_budget;
      system.accepted(h, y.data(), f_.data(), new_.data());
      std::copy(new_.begin(), new_.end(), y.begin());
      rest = h >= rest ? 0 : rest - h;
      h = std::min(2 * h, nominal);
    }
  }
  return report;
}

}  // namespace slew::math
