// Which steps of one writer's topic have come: the contiguous part, and what lies ahead of a gap.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/time.h"

namespace slew::recorder {

class StreamGaps {
 public:
  // depth: how far ahead of a gap steps are remembered; a gap that is left further behind counts as lost.
  explicit StreamGaps(std::size_t depth = 4096) : ahead_(depth, false) {}

  enum class Arrival : std::uint8_t { new_step, duplicate };

  Arrival arrived(StepIndex step) {
    if (step < next_) return Arrival::duplicate;
    while (step >= next_ + static_cast<StepIndex>(ahead_.size())) give_up_one();
    if (ahead_[slot(step)]) return Arrival::duplicate;
    ahead_[slot(step)] = true;
    if (step > newest_) newest_ = step;
    while (ahead_[slot(next_)]) {
      ahead_[slot(next_)] = false;
      ++next_;
    }
    return Arrival::new_step;
  }

  // All steps below this one have come (or are counted as lost).
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

  // Counts every step up to and including `last` that has not come as lost.
  void close_at(StepIndex last) {
    while (next_ <= last) give_up_one();
  }

 private:
  void give_up_one() {
    if (!ahead_[slot(next_)]) ++lost_;
    ahead_[slot(next_)] = false;
    ++next_;
  }
  [[nodiscard]] std::size_t slot(StepIndex step) const noexcept {
    return static_cast<std::size_t>(step) % ahead_.size();
  }

  std::vector<bool> ahead_;
  StepIndex next_ = 0;
  StepIndex newest_ = -1;
  std::uint64_t lost_ = 0;
};

}  // namespace slew::recorder
