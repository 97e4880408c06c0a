// SPDX-License-Identifier: Apache-2.0
#include "observer/step_values.h"

#include <iterator>
#include <utility>

namespace slew::observer {
namespace {

constexpr std::size_t kMostWaitingSteps = 64;

}  // namespace

const std::vector<double>* StepValues::take(const wire::VariableBlock& block) {
  Values* values = nullptr;
  for (std::size_t i = 0; i < places_.size(); ++i) {
    const std::optional<VariablePlace>& place = places_[i];
    if (!place || place->role != block.header.role || place->index < block.first) continue;
    const std::size_t at = place->index - block.first;
    if (at >= block.values.size()) continue;
    if (values == nullptr) {
      values = &steps_[block.header.step];
      values->values.resize(places_.size());
      values->has.resize(places_.size());
    }
    values->values[i] = block.values[at];
    values->count += values->has[i] ? 0 : 1;
    values->has[i] = true;
  }
  if (values == nullptr) return nullptr;
  if (values->count == places_.size()) {
    whole_ = std::move(values->values);
    // blocks of a node arrive in order: older steps stay incomplete
    const auto behind = steps_.upper_bound(block.header.step);
    incomplete_ += static_cast<std::uint64_t>(std::distance(steps_.begin(), behind)) - 1;
    steps_.erase(steps_.begin(), behind);
    return &whole_;
  }
  if (steps_.size() > kMostWaitingSteps) {
    steps_.erase(steps_.begin());
    ++incomplete_;
  }
  return nullptr;
}

}  // namespace slew::observer
