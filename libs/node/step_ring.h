// SPDX-License-Identifier: Apache-2.0
// Messages by step number, as many as the window needs: a later step overwrites the one `depth` before it.
#pragma once

#include <cstddef>
#include <vector>

#include "core/time.h"

namespace slew::node {

template <typename Message>
class StepRing {
 public:
  explicit StepRing(std::size_t depth) : slots_(depth), steps_(depth, kEmpty) {}

  // Slot to decode a message of this step into; its old content is dropped.
  [[nodiscard]] Message& put(StepIndex step) noexcept {
    const std::size_t i = slot(step);
    steps_[i] = step;
    return slots_[i];
  }
  [[nodiscard]] const Message* find(StepIndex step) const noexcept {
    const std::size_t i = slot(step);
    return steps_[i] == step ? &slots_[i] : nullptr;
  }
  [[nodiscard]] Message* find(StepIndex step) noexcept {
    const std::size_t i = slot(step);
    return steps_[i] == step ? &slots_[i] : nullptr;
  }
  void remove(StepIndex step) noexcept { steps_[slot(step)] = kEmpty; }
  void clear() noexcept {
    for (StepIndex& step : steps_) step = kEmpty;
  }
  // All places, filled or not.
  template <typename Visit>
  void for_each(Visit visit) {
    for (Message& slot : slots_) visit(slot);
  }
  [[nodiscard]] std::size_t depth() const noexcept { return slots_.size(); }

 private:
  static constexpr StepIndex kEmpty = -1000;
  // steps from -1 on
  [[nodiscard]] std::size_t slot(StepIndex step) const noexcept {
    return static_cast<std::size_t>(step + 1) % slots_.size();
  }
  std::vector<Message> slots_;
  std::vector<StepIndex> steps_;
};

}  // namespace slew::node
