// SPDX-License-Identifier: Apache-2.0
// The values of all variables at one step, taken now and then from the blocks of a session.
//
// A snapshot is requested, and becomes whole when every node that computes in lock-step has published the same step:
// the first step that begins after the request. Nodes that follow at their own pace (flex, sensors) give their newest
// values. Blocks of other steps cost nothing.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include "observer/session_view.h"
#include "transport/wire.h"

namespace slew::gateway {

class StepSnapshot {
 public:
  // Number of variables of a role, from its directory.
  void set_total(wire::Role role, std::size_t total);
  // Another session or epoch: no values; a request stays.
  void forget_values();

  // Requests the next whole step; a request that waits stays.
  void request() noexcept { is_requested_ = true; }
  [[nodiscard]] bool is_requested() const noexcept { return is_requested_; }
  // True: the requested step has become whole.
  bool take(const wire::VariableBlock& block);
  // Takes the newest values of a view that has received the same blocks, for a session that stands or a recording.
  // False: there are none.
  bool take(const observer::SessionView& view);

  // NaN: there is no value.
  [[nodiscard]] double value(const observer::VariablePlace& place) const noexcept;
  [[nodiscard]] StepIndex step() const noexcept { return step_; }

  // Requests whose step never became whole: a block was lost.
  [[nodiscard]] std::uint64_t incomplete() const noexcept { return incomplete_; }

 private:
  struct OfRole {
    std::vector<double> values;  // whole
    std::vector<double> next;    // of the step that is becoming whole
    std::size_t count = 0;       // values of `next` that have arrived
    bool is_there = false;
  };

  void begin(StepIndex step);
  [[nodiscard]] bool is_whole() const noexcept;
  void accept();

  std::array<OfRole, wire::kRoles> roles_;
  bool is_requested_ = false;
  std::optional<StepIndex> target_;  // step that is becoming whole
  StepIndex newest_ = kJoinStep;     // step of any block of a lock-step node
  StepIndex step_ = kJoinStep;
  std::uint64_t incomplete_ = 0;
};

}  // namespace slew::gateway
