// SPDX-License-Identifier: Apache-2.0
#include "node/free_loop.h"

#include <algorithm>

namespace slew::node {

using wire::Role;
using wire::Topic;

bool FreeLoop::receive_tick(const transport::Received& received, const wire::Header& header, StepIndex n,
                            std::int64_t now_ns) {
  if (header.step > newest_tick_) {
    newest_tick_ = header.step;
    newest_tick_ns_ = now_ns;
  }
  if (header.step >= n) return ticks_.keep(received, header.step, n, member_.refusals());
  receive_late(received);
  return false;
}

// Commands of a tick are taken once: a tick that was requested may arrive twice.
void FreeLoop::receive_late(const transport::Received& received) {
  if (!late_tick_.put(received, 0)) {
    ++member_.refusals().undecodable;
    return;
  }
  const wire::Tick& tick = *late_tick_.find(0);
  if (std::erase(missed_ticks_, tick.header.step) == 0) {
    ++member_.refusals().duplicate;
  } else {
    late_commands_.insert(late_commands_.end(), tick.commands.begin(), tick.commands.end());
    if (tick.header.step == newest_tick_) controls_.assign(tick.controls.begin(), tick.controls.end());
    if (const TickEnd end = end_of(tick.flags); end != TickEnd::none) end_ = end;
  }
}

StepLoop::Next FreeLoop::next(StepIndex n, std::int64_t now_ns, StepInput& input) {
  const wire::Tick* tick = ticks_.find(n);
  if (end_ == TickEnd::none && tick != nullptr) end_ = end_of(tick->flags);
  if (end_ != TickEnd::none) return end_ == TickEnd::fault ? Next::wait : Next::end;
  if (tick == nullptr && newest_tick_ < n && !is_time_over(n, now_ns)) return Next::wait;
  samples_.find_newest(n, input.partners);
  const StepIndex age = std::max(input.partners.mechanism_age, input.partners.actuators_age);
  if (waits_for_sample(n, age, now_ns)) return Next::wait;

  use_tick(n, tick, input);
  if (n - age > used_step_ + 1) lost_ += static_cast<std::uint32_t>(n - age - used_step_ - 1);
  used_step_ = std::max(used_step_, n - age);
  input.released_by = n;
  input.used_step = used_step_;
  input.lost = lost_;
  input.quality = used_step_ < n ? coupling::Quality::extrapolated : coupling::Quality::ok;
  return Next::step;
}

// The step may be done without its tick.
bool FreeLoop::is_time_over(StepIndex n, std::int64_t now_ns) const noexcept {
  const bool is_far_ahead = newest_tick_ == kNoStep || n - newest_tick_ > member_.session().window;
  return !is_far_ahead && !is_withheld(member_, n) && now_ns >= time_limit_ns(n);
}

// age: age of the oldest sample that the step would use [steps]
bool FreeLoop::waits_for_sample(StepIndex n, StepIndex age, std::int64_t now_ns) noexcept {
  // a node behind the ticks waits for no sample: its partner is ahead
  if (age > 0 && newest_tick_ <= n) {
    if (sample_due_ns_ == 0) sample_due_ns_ = now_ns + wait_budget_.ns;
    if (now_ns < sample_due_ns_) return true;
  }
  sample_due_ns_ = 0;
  return false;
}

void FreeLoop::use_tick(StepIndex n, const wire::Tick* tick, StepInput& input) {
  if (tick != nullptr) {
    controls_.assign(tick->controls.begin(), tick->controls.end());
    tick_flags_ = tick->flags;
    input.commands = tick->commands;
  } else {
    if (missed_ticks_.size() == kRingDepth) missed_ticks_.erase(missed_ticks_.begin());
    missed_ticks_.push_back(n);
  }
  handed_commands_.clear();
  handed_commands_.swap(late_commands_);
  input.late_commands = handed_commands_;
  input.controls = controls_;
}

void FreeLoop::collect_missing(StepIndex, MissingMessages& missing) const noexcept {
  for (const StepIndex step : missed_ticks_) missing.push_back({Role::io, Topic::tick, step});
}

std::int64_t FreeLoop::time_limit_ns(StepIndex n) const noexcept {
  return newest_tick_ns_ + (n - newest_tick_) * member_.session().step_ns + wait_budget_.ns;
}

std::int64_t FreeLoop::next_poll_ns(StepIndex n, std::int64_t now_ns, std::int64_t request_due_ns) const noexcept {
  if (newest_tick_ == kNoStep) return now_ns + kProbeInterval.ns;
  const std::int64_t step_ns = sample_due_ns_ > 0 ? sample_due_ns_ : time_limit_ns(n);
  return missed_ticks_.empty() ? step_ns : std::min(step_ns, request_due_ns);
}

void FreeLoop::restart() noexcept {
  ticks_.clear();
  newest_tick_ = kNoStep;
  missed_ticks_.clear();
  late_commands_.clear();
  controls_.clear();
  tick_flags_ = 0;
  sample_due_ns_ = 0;
  used_step_ = kJoinStep;
  lost_ = 0;
  end_ = TickEnd::none;
}

void FreeLoop::take_over(const wire::SampleState& published) noexcept {
  used_step_ = published.used_step;
  lost_ = published.lost;
}

}  // namespace slew::node
