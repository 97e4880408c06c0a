// SPDX-License-Identifier: Apache-2.0
#include "node/tick_counter.h"

#include <algorithm>
#include <iomanip>
#include <iterator>
#include <limits>
#include <sstream>

#include "transport/session_state.h"

namespace slew::node {

std::string text_of(const TickSpan& span) {
  std::ostringstream text;
  text << std::setprecision(std::numeric_limits<double>::max_digits10) << span.wall_time << ' ' << span.paused_time
       << ' ' << span.steps << ' ' << span.epoch << ' ' << span.next << ' ' << span.behind_end;
  return text.str();
}

std::optional<TickSpan> tick_span_of(const std::string& text) {
  std::istringstream words(text);
  TickSpan span;
  words >> span.wall_time >> span.paused_time >> span.steps >> span.epoch >> span.next >> span.behind_end;
  return words ? std::optional(span) : std::nullopt;
}

void TickCounter::take(const wire::Header& header, std::uint32_t flags) {
  if (header.phase != wire::Phase::running) return;
  Epoch& epoch = epochs_[header.epoch];
  if ((flags & static_cast<std::uint32_t>(wire::TickFlag::end)) != 0) {
    epoch.end = std::min(epoch.end.value_or(header.step), header.step);
    return;
  }
  epoch.first = epoch.has_tick ? std::min(epoch.first, header.step) : header.step;
  epoch.last = epoch.has_tick ? std::max(epoch.last, header.step) : header.step;
  epoch.has_tick = true;
}

void TickCounter::take_time(std::int64_t sent_ns) {
  if (sent_ns == 0) return;
  if (last_ns_ != 0 && sent_ns < last_ns_) {
    is_in_order_ = false;
    return;
  }
  if (last_ns_ != 0) {
    const std::int64_t gap_ns = sent_ns - last_ns_;
    const std::int64_t running_ns = was_paused(last_ns_, sent_ns) ? std::min(gap_ns, step_ns_) : gap_ns;
    wall_time_ += static_cast<double>(running_ns) * 1e-9;
    paused_time_ += static_cast<double>(gap_ns - running_ns) * 1e-9;
  }
  last_ns_ = sent_ns;
}

void TickCounter::take_status(const wire::NodeStatus& io, std::int64_t sent_ns) {
  if (io.header.role != wire::Role::io) return;
  const bool is_change = paused_since_.empty() || paused_since_.rbegin()->second != transport::is_pause(io);
  if (is_change) paused_since_[sent_ns] = transport::is_pause(io);
}

bool TickCounter::was_paused(std::int64_t from_ns, std::int64_t to_ns) const {
  auto change = paused_since_.upper_bound(from_ns);
  if (change != paused_since_.begin() && std::prev(change)->second) return true;
  for (; change != paused_since_.end() && change->first < to_ns; ++change) {
    if (change->second) return true;
  }
  return false;
}

TickSpan TickCounter::span() const {
  TickSpan span;
  span.wall_time = wall_time_;
  span.paused_time = paused_time_;
  for (const auto& [number, epoch] : epochs_) {
    if (!epoch.has_tick) continue;
    span.steps += epoch.last - epoch.first + 1;
    span.epoch = number;
    span.next = epoch.last + 1;
    if (epoch.end && epoch.last >= *epoch.end) {
      span.behind_end += static_cast<std::uint64_t>(epoch.last - std::max(epoch.first, *epoch.end) + 1);
    }
  }
  return span;
}

}  // namespace slew::node
