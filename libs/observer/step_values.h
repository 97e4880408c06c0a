// SPDX-License-Identifier: Apache-2.0
// Values of chosen variables of one step, which come in blocks of several nodes: whole when each of them has arrived.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "observer/session_view.h"
#include "transport/wire.h"

namespace slew::observer {

class StepValues {
 public:
  // count: number of variables.
  explicit StepValues(std::size_t count) : places_(count) {}

  [[nodiscard]] std::size_t size() const noexcept { return places_.size(); }
  void set_place(std::size_t variable, const VariablePlace& place) { places_[variable] = place; }
  // Places and steps are those of another session or epoch.
  void forget_places() { places_.assign(places_.size(), std::nullopt); }
  void forget_steps() { steps_.clear(); }

  // The values of the block's step if it makes them whole; valid until the next call.
  [[nodiscard]] const std::vector<double>* take(const wire::VariableBlock& block);

  // Steps that never became whole: a block was lost, or left out under load.
  [[nodiscard]] std::uint64_t incomplete() const noexcept { return incomplete_; }

 private:
  struct Values {
    std::vector<double> values;
    std::vector<bool> has;
    std::size_t count = 0;
  };
  std::vector<std::optional<VariablePlace>> places_;
  std::map<StepIndex, Values> steps_;  // not whole yet
  std::vector<double> whole_;
  std::uint64_t incomplete_ = 0;
};

}  // namespace slew::observer
