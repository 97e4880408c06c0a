// SPDX-License-Identifier: Apache-2.0
// The steps of one writer's topic that have arrived: the contiguous part, and the steps ahead of a gap.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/time.h"

namespace slew::recorder_node {

class StreamGaps {
 public:
  // depth: number of steps ahead of a gap that are remembered; a gap further behind counts as lost.
  // first: step with which the stream begins.
  explicit StreamGaps(std::size_t depth = 4096, StepIndex first = 0)
      : ahead_(depth, false), next_(first), newest_(first - 1) {}

  enum class Arrival : std::uint8_t { new_step, duplicate, too_far };

  // A step two depths ahead or more is accepted only after a second one near it: one wrong number must not give up all
  // steps before it, but a reader that stood still for long must find its stream again.
  Arrival arrived(StepIndex step) {
    const auto depth = static_cast<StepIndex>(ahead_.size());
    if (step < next_) return Arrival::duplicate;
    if (step >= next_ + 2 * depth) {
      const bool is_confirmed = doubted_ >= 0 && step > doubted_ && step - doubted_ < depth;
      doubted_ = step;
      if (!is_confirmed) return Arrival::too_far;
    }
    give_up_below(step - depth + 1);
    if (ahead_[slot(step)]) return Arrival::duplicate;
    ahead_[slot(step)] = true;
    if (step > newest_) newest_ = step;
    advance();
    return Arrival::new_step;
  }

  // All steps below this one have arrived or are counted as lost.
  [[nodiscard]] StepIndex next() const noexcept { return next_; }
  [[nodiscard]] StepIndex newest() const noexcept { return newest_; }
  [[nodiscard]] bool has_gap() const noexcept { return newest_ >= next_; }
  // Last step of the first gap.
  [[nodiscard]] StepIndex gap_end() const noexcept {
    StepIndex step = next_;
    while (step < newest_ && !ahead_[slot(step + 1)]) ++step;
    return step;
  }
  [[nodiscard]] std::uint64_t lost() const noexcept { return lost_; }

  // Counts every missing step up to and including `last` as lost.
  void close_at(StepIndex last) { give_up_below(last + 1); }
  // Counts every missing step before `end` as lost.
  void give_up_before(StepIndex end) { give_up_below(end); }
  // Steps counted as lost since the last call.
  struct Lost {
    StepIndex first = 0, last = 0;
    std::uint64_t steps = 0;
  };
  [[nodiscard]] Lost take_lost() noexcept { return std::exchange(newly_lost_, {}); }

 private:
  void advance() noexcept {
    while (ahead_[slot(next_)]) {
      ahead_[slot(next_)] = false;
      ++next_;
    }
  }
  void give_up_below(StepIndex end) {
    // steps beyond a depth are not remembered: none of them has arrived
    const StepIndex remembered = std::min(end, next_ + static_cast<StepIndex>(ahead_.size()));
    for (; next_ < remembered; ++next_) {
      if (!ahead_[slot(next_)]) lose(next_, next_);
      ahead_[slot(next_)] = false;
    }
    if (next_ < end) lose(next_, end - 1);
    next_ = std::max(next_, end);
    advance();
  }
  void lose(StepIndex first, StepIndex last) noexcept {
    const auto steps = static_cast<std::uint64_t>(last - first + 1);
    if (newly_lost_.steps == 0) newly_lost_.first = first;
    newly_lost_.last = last;
    newly_lost_.steps += steps;
    lost_ += steps;
  }
  [[nodiscard]] std::size_t slot(StepIndex step) const noexcept {
    return static_cast<std::size_t>(step) % ahead_.size();
  }

  std::vector<bool> ahead_;
  StepIndex next_;
  StepIndex newest_;
  StepIndex doubted_ = -1;  // last step that was not accepted
  std::uint64_t lost_ = 0;
  Lost newly_lost_;
};

}  // namespace slew::recorder_node
