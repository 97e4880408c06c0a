// SPDX-License-Identifier: Apache-2.0
#include "coupling/own_past.h"

#include <algorithm>

#include "core/check.h"

namespace slew::coupling {
namespace {

constexpr StepIndex kNone = -1;

std::size_t slot(StepIndex n) noexcept {
  return static_cast<std::size_t>(n % kRememberedSteps);
}

}  // namespace

OwnPast::OwnPast(std::size_t ports)
    : ports_(ports),
      steps_(static_cast<std::size_t>(kRememberedSteps), kNone),
      values_(static_cast<std::size_t>(kRememberedSteps) * 2 * ports, 0.0) {}

void OwnPast::clear() noexcept {
  std::fill(steps_.begin(), steps_.end(), kNone);
  latest_ = kNone;
}

const double* OwnPast::row(StepIndex n) const noexcept {
  return values_.data() + slot(n) * 2 * ports_;
}

void OwnPast::keep(StepIndex n, std::span<const double> first, std::span<const double> second) noexcept {
  SLEW_ASSERT(first.size() == ports_ && second.size() == ports_);
  steps_[slot(n)] = latest_ = n;
  double* const values = values_.data() + slot(n) * 2 * ports_;
  for (std::size_t i = 0; i < ports_; ++i) {
    values[2 * i] = first[i];
    values[2 * i + 1] = second[i];
  }
}

bool OwnPast::has(StepIndex n) const noexcept {
  return n >= 0 && steps_[slot(n)] == n;
}

void OwnPast::correct(StepIndex since, std::size_t port, double first, double second) noexcept {
  for (StepIndex n = since; n <= latest_; ++n) {
    if (!has(n)) continue;
    double* const values = values_.data() + slot(n) * 2 * ports_ + 2 * port;
    values[0] += first;
    values[1] += second;
  }
}

void OwnPast::save(StateWriter& bytes) const {
  bytes.number(latest_);
  bytes.numbers(std::span<const StepIndex>(steps_));
  bytes.numbers(values_);
}

void OwnPast::load(StateReader& bytes) noexcept {
  bytes.number(latest_);
  bytes.numbers(std::span<StepIndex>(steps_));
  bytes.numbers(values_);
  // each step in its slot, none older than the history
  bool can_be = latest_ >= kNone && latest_ <= kLastStep;
  for (std::size_t i = 0; can_be && i < steps_.size(); ++i) {
    const StepIndex step = steps_[i];
    can_be = step == kNone || (step >= 0 && slot(step) == i && step <= latest_ && step > latest_ - kRememberedSteps);
  }
  if (can_be) return;
  clear();
  bytes.refuse();
}

}  // namespace slew::coupling
