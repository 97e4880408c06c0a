// SPDX-License-Identifier: Apache-2.0
// Counts a session's ticks as they arrive: steps, wall time and pauses.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "core/time.h"
#include "transport/wire.h"

namespace slew::node {

// Steps of all epochs, including those of lost ticks between two others, and the wall time from the first tick to the
// last by the stamps of their writer. If the session was paused between two ticks, one step of that time counts as
// running, the rest as paused.
struct TickSpan {
  double wall_time = 0;    // s, without pauses
  double paused_time = 0;  // s
  StepIndex steps = 0;
  std::uint32_t epoch = 0;       // the last one
  StepIndex next = 0;            // step after the last one of that epoch
  std::uint64_t behind_end = 0;  // ticks after the END of their epoch; a session in order has none
};

// One line, and back; none: the text is no such line.
[[nodiscard]] std::string text_of(const TickSpan& span);
[[nodiscard]] std::optional<TickSpan> tick_span_of(const std::string& text);

class TickCounter {
 public:
  explicit TickCounter(SimDuration step) : step_ns_(step.ns) {}
  // A tick, in any order.
  void take(const wire::Header& header, std::uint32_t flags);
  // Time of the tick by the wall clock of its writer, 0: unknown. To be called in order, after take_status() of earlier
  // statuses.
  void take_time(std::int64_t sent_ns);
  void take_status(const wire::NodeStatus& io, std::int64_t sent_ns);
  // No tick arrived after a later one.
  [[nodiscard]] bool is_in_order() const noexcept { return is_in_order_; }
  [[nodiscard]] TickSpan span() const;

 private:
  struct Epoch {
    bool has_tick = false;
    StepIndex first = 0, last = 0;
    std::optional<StepIndex> end;  // the first step that an END names
  };
  [[nodiscard]] bool was_paused(std::int64_t from_ns, std::int64_t to_ns) const;

  std::int64_t step_ns_;
  std::map<std::uint32_t, Epoch> epochs_;
  std::map<std::int64_t, bool> paused_since_;  // at each status of io that changed it
  std::int64_t last_ns_ = 0;
  double wall_time_ = 0, paused_time_ = 0;
  bool is_in_order_ = true;
};

}  // namespace slew::node
