// SPDX-License-Identifier: Apache-2.0
// Wall times of ticks and of the controllers' values that they use, for the session's statistics.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/time.h"
#include "node/step_timing.h"
#include "transport/wire.h"

namespace slew::io_node {

class TickTimes {
 public:
  TickTimes(std::size_t channels, SimDuration step);

  // ---- ticks
  void begin(std::int64_t now_ns) noexcept { last_tick_ns_ = now_ns - step_.ns; }
  void count_tick(StepIndex n, std::int64_t now_ns) noexcept {
    tick_ns_[static_cast<std::size_t>(n) % tick_ns_.size()] = last_tick_ns_ = now_ns;
  }
  [[nodiscard]] std::int64_t last_tick_ns() const noexcept { return last_tick_ns_; }
  // Time from the tick of step based_on to now, when n is the next step.
  [[nodiscard]] std::int64_t since_tick_ns(StepIndex based_on, StepIndex n, std::int64_t now_ns) const noexcept;

  // ---- waits
  // From now on the next tick waits for this role; io's own: for values of lockstep controllers. The time since the
  // last call, from counted_from_ns on, goes to the role that it waited for until now.
  void count_wait(std::optional<wire::Role> role, std::int64_t counted_from_ns, std::int64_t now_ns,
                  node::NodeTiming& timing) noexcept;
  void end_wait() noexcept { waits_for_.reset(); }

  // ---- values of controllers
  void receive_value(std::size_t channel, std::int64_t came_ns) noexcept { value_ns_[channel] = came_ns; }
  // Time of the oldest value that no tick had used; 0: none. All are used now.
  [[nodiscard]] std::int64_t use_values() noexcept;
  // The ticks are held: the wait of the values for a tick begins now.
  void restart_values(std::int64_t now_ns) noexcept;
  void drop_values() noexcept;

 private:
  SimDuration step_;
  std::vector<std::int64_t> tick_ns_;  // wall time of the last ticks, by step modulo their number
  std::int64_t last_tick_ns_ = 0;
  std::optional<wire::Role> waits_for_;
  std::int64_t waits_since_ns_ = 0;
  std::vector<std::int64_t> value_ns_;  // by channel, of the newest value that no tick has used; 0: none
};

}  // namespace slew::io_node
