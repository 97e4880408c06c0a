// SPDX-License-Identifier: Apache-2.0
#include "io_node/tick_times.h"

#include <algorithm>

namespace slew::io_node {
namespace {

constexpr std::size_t kTimedTicks = 1024;

}  // namespace

TickTimes::TickTimes(std::size_t channels, SimDuration step)
    : step_(step), tick_ns_(kTimedTicks), value_ns_(channels) {}

std::int64_t TickTimes::since_tick_ns(StepIndex based_on, StepIndex n, std::int64_t now_ns) const noexcept {
  const StepIndex delay = n - based_on;
  if (delay >= static_cast<StepIndex>(kTimedTicks)) return delay * step_.ns;
  return now_ns - tick_ns_[static_cast<std::size_t>(based_on) % kTimedTicks];
}

void TickTimes::count_wait(std::optional<wire::Role> role, std::int64_t counted_from_ns, std::int64_t now_ns,
                           node::NodeTiming& timing) noexcept {
  const std::int64_t from_ns = std::max(waits_since_ns_, counted_from_ns);
  if (waits_for_ && now_ns > from_ns) {
    std::atomic<std::int64_t>& waited_ns = timing.waited_ns[static_cast<std::size_t>(*waits_for_)];
    waited_ns.store(waited_ns.load(std::memory_order_relaxed) + now_ns - from_ns, std::memory_order_relaxed);
  }
  waits_for_ = role;
  waits_since_ns_ = now_ns;
}

std::int64_t TickTimes::use_values() noexcept {
  std::int64_t oldest_ns = 0;
  for (std::int64_t& came_ns : value_ns_) {
    if (came_ns != 0 && (oldest_ns == 0 || came_ns < oldest_ns)) oldest_ns = came_ns;
    came_ns = 0;
  }
  return oldest_ns;
}

void TickTimes::restart_values(std::int64_t now_ns) noexcept {
  for (std::int64_t& came_ns : value_ns_) {
    if (came_ns != 0) came_ns = now_ns;
  }
}

void TickTimes::drop_values() noexcept {
  std::ranges::fill(value_ns_, 0);
}

}  // namespace slew::io_node
