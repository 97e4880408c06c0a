// SPDX-License-Identifier: Apache-2.0
#include "node/health_report.h"

#include <algorithm>

namespace slew::node {

bool LoopWatch::is_busy() const noexcept {
  const auto state = static_cast<wire::NodeState>(loop_.state.load());
  return state < wire::NodeState::ready || state >= wire::NodeState::ended ||
         loop_.waits_for_disk.load(std::memory_order_relaxed);
}

std::int64_t LoopWatch::longest_ns() const noexcept {
  const auto steps = std::max<std::int64_t>(1, static_cast<std::int64_t>(loop_.steps_done.load()));
  return std::max(kLoopStalled.ns, kStepsOfALoop * (loop_.step_time_sum_ns.load() / steps));
}

bool LoopWatch::poll() noexcept {
  const std::uint64_t signs = loop_.turns.load(std::memory_order_relaxed) + loop_.steps_done.load();
  const bool is_alive = signs != signs_ || is_busy();
  signs_ = signs;
  polls_ = is_alive ? 0 : polls_ + 1;
  return stood_for().ns >= longest_ns();
}

void HealthReport::send() {
  HealthState& h = node_.health();
  if (!h.has_session.load(std::memory_order_acquire)) return;
  wire::Health message;
  message.header = node_.member().header(wire::Phase::running, h.step.load(), h.epoch.load());
  message.state = static_cast<wire::NodeState>(h.state.load());
  message.is_waiting = h.is_waiting.load();
  message.waiting_for = static_cast<wire::Role>(h.waiting_for.load());
  message.waiting_step = h.waiting_step.load();
  message.steps_done = h.steps_done.load();
  message.resends_asked = h.resends_asked.load();
  message.resends_answered = h.resends_answered.load();
  message.refused_messages = h.refused.load();
  message.slip_ns = h.slip_ns.load();
  const std::int64_t sum_ns = h.step_time_sum_ns.load();
  if (message.steps_done > last_steps_) {
    message.step_time_mean =
        static_cast<double>(sum_ns - last_sum_ns_) * 1e-9 / static_cast<double>(message.steps_done - last_steps_);
  }
  message.step_time_max = static_cast<double>(h.step_time_max_ns.exchange(0)) * 1e-9;
  last_steps_ = message.steps_done;
  last_sum_ns_ = sum_ns;
  add_timing(message);
  // a lost health message needs no reaction: the next one follows
  if (!transport::encode(message, buffer_)) return;
  static_cast<void>(node_.member().transport().publish(wire::Topic::health, buffer_));
}

void HealthReport::add_timing(wire::Health& message) const {
  NodeTiming& timing = node_.timing();
  message.overruns = timing.overruns.load();
  message.longest_overrun = timing.longest_overrun.load();
  message.release_jitter = quantiles_of(timing.release_jitter);
  message.execution = quantiles_of(timing.execution);
  message.cpu_time = quantiles_of(timing.cpu_time);
  message.wait = quantiles_of(timing.wait);
  message.response = quantiles_of(timing.response);
  message.input_latency = quantiles_of(timing.input_latency);
  message.response_recent = static_cast<double>(timing.response_recent_ns.exchange(0)) * 1e-9;
  for (std::size_t i = 0; i < message.waited.size(); ++i) {
    message.waited[i] = static_cast<double>(timing.waited_ns[i].load()) * 1e-9;
  }
  message.allocations = timing.allocations.load();
  message.carrier_allocations = timing.carrier_allocations.load();
  message.transitions = timing.transitions.load();
  const SessionBooks books = timing.books.read();
  if (books.due == 0) return;
  message.header.step = books.run;  // read with the books, at one moment
  message.steps_due = books.due;
  message.steps_skipped = books.skipped;
  message.lag_ns = books.lag_ns;
  message.rest_ns = books.rest_ns;
}

}  // namespace slew::node
