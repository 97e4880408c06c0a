// SPDX-License-Identifier: Apache-2.0
#include "math/runge_kutta4.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace slew::math {
namespace {

constexpr int kFirstIterations = 60;  // iterations from an arbitrary vector, and at suspicious sub-steps
constexpr double kGrossError =
    1e-2;                            // share of a state and its scale, in one sub-step: a swing followed with w h = 0.5
constexpr double kFifthOrder = 0.4;  // (4)
constexpr int kMostSuspicions = 4;   // suspicious sub-steps examined per interval
constexpr int kNextIterations = 4;   // iterations from the vector of the previous interval

}  // namespace

RungeKutta4::RungeKutta4(std::size_t jacobian_stride, StiffOptions options)
    : options_(std::move(options)),
      radius_(options_.scale, jacobian_stride),
      f_(options_.scale.size()),
      k2_(f_),
      k3_(f_),
      k4_(f_),
      stage_(f_),
      new_(f_) {}

void RungeKutta4::restart() noexcept {
  radius_.restart();
  is_first_ = true;
}

void RungeKutta4::watch(StiffSystem& system, const double* y, const double* f, double h, int iterations,
                        StiffReport& report) noexcept {
  const double lambda = radius_.update(system.jacobian(y, f), iterations);
  is_first_ = false;
  const double ratio = h * lambda / kExplicitLimit;
  if (ratio < report.largest_error) return;
  report.largest_error = ratio;
  if (ratio <= 1) return;
  report.is_unstable = true;
  report.worst_state = radius_.owner();
}

RungeKutta4::Differences RungeKutta4::differences() const noexcept {
  Differences sum;
  for (std::size_t i = 0; i < f_.size(); ++i) {
    const double d = (k3_[i] - k2_[i]) / options_.scale[i], e = (k2_[i] - f_[i]) / options_.scale[i];
    sum.later += d * d;
    sum.earlier += e * e;
  }
  return sum;
}

// (2)
bool RungeKutta4::is_suspicious() const noexcept {
  const Differences sum = differences();
  return 4 * sum.later > kExplicitLimit * kExplicitLimit * sum.earlier;
}

// (3), (4), and the system's own balance
void RungeKutta4::watch_error(StiffSystem& system, const double* y, double h, StiffReport& report) noexcept {
  double largest = kGrossError, kept = 0;
  for (std::size_t i = 0; i < f_.size(); ++i) {
    const double share =
        h / 3 * std::fabs(k3_[i] - k2_[i]) / (options_.scale[i] + std::max(std::fabs(y[i]), std::fabs(new_[i])));
    if (share > kGrossError && options_.keeps_error(i)) kept = std::max(kept, share);
    if (!(share > largest)) continue;
    largest = share;
    report.is_unstable = true;
    report.worst_state = static_cast<std::int32_t>(i);
  }
  if (kept > 0) {
    const Differences sum = differences();
    report.accepted_error += kept * (kFifthOrder * sum.later < sum.earlier ? kFifthOrder * sum.later / sum.earlier : 1);
  }
  const std::int32_t impossible = system.impossible_state(h, y, new_.data());
  if (impossible < 0) return;
  report.accepted_error += kGrossShare;
  report.is_unstable = true;
  report.worst_state = impossible;
}

StiffReport RungeKutta4::advance(StiffSystem& system, std::span<double> y, double duration) noexcept {
  StiffReport report;
  const std::size_t n = y.size();
  const double parts = std::max(1.0, std::ceil(duration / options_.maximum_step * (1 - 1e-12)));
  const double h = duration / parts;
  int suspicions = 0;
  for (double part = 0; part < parts; ++part) {
    system.derivative(y.data(), f_.data());
    if (part == 0) watch(system, y.data(), f_.data(), h, is_first_ ? kFirstIterations : kNextIterations, report);
    for (std::size_t i = 0; i < n; ++i) stage_[i] = y[i] + 0.5 * h * f_[i];
    system.derivative(stage_.data(), k2_.data());
    for (std::size_t i = 0; i < n; ++i) stage_[i] = y[i] + 0.5 * h * k2_[i];
    system.derivative(stage_.data(), k3_.data());
    if (suspicions < kMostSuspicions && is_suspicious()) {
      ++suspicions;
      watch(system, stage_.data(), k3_.data(), h, kFirstIterations, report);
    }
    for (std::size_t i = 0; i < n; ++i) stage_[i] = y[i] + h * k3_[i];
    system.derivative(stage_.data(), k4_.data());
    for (std::size_t i = 0; i < n; ++i) new_[i] = y[i] + h / 6 * (f_[i] + 2 * k2_[i] + 2 * k3_[i] + k4_[i]);
    const auto bad = std::find_if(new_.begin(), new_.end(), [](double x) { return !std::isfinite(x); });
    if (bad != new_.end()) {
      report.is_finite = false;
      report.worst_state = static_cast<std::int32_t>(bad - new_.begin());
      return report;
    }
    watch_error(system, y.data(), h, report);
    ++report.accepted;
    system.accepted(h, y.data(), f_.data(), new_.data());
    std::copy(new_.begin(), new_.end(), y.begin());
  }
  return report;
}

}  // namespace slew::math
