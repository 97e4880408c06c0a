// SPDX-License-Identifier: Apache-2.0
#include "analysis/stress/yardstick.h"

#include <pthread.h>
#include <sched.h>

#include <algorithm>

#include "core/real_time_thread.h"

namespace slew::analysis {
namespace {

constexpr std::int32_t kNoMore = -1;  // a round

void take_place(const YardstickLoop& loop) noexcept {
  if (loop.priority > 0) {
    sched_param parameters{};
    parameters.sched_priority = loop.priority;
    pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters);
  }
  if (loop.cpu >= 0) static_cast<void>(run_on_cpu(loop.cpu));
}

void count_up(std::atomic<std::int32_t>& counter) noexcept {
  ++counter;
  counter.notify_one();
}

void wait_for(const std::atomic<std::int32_t>& counter, std::int32_t value) noexcept {
  for (std::int32_t at = counter; at < value; at = counter) counter.wait(at);
}

}  // namespace

void burn(SimDuration cpu_time) noexcept {
  const std::int64_t end_ns = node::thread_cpu_ns() + cpu_time.ns;
  while (node::thread_cpu_ns() < end_ns) {
  }
}

void Yardstick::start(const YardstickRules& rules, SimDuration slice) {
  wait();
  is_stopped_ = false;
  is_running_ = true;
  thread_ = std::thread([this, rules, slice] {
    lead(rules, slice);
    is_running_ = false;
  });
}

void Yardstick::wait() {
  if (thread_.joinable()) thread_.join();
}

void Yardstick::release(std::int32_t round, std::int64_t due_ns) noexcept {
  done_ = 0;
  due_ns_ = due_ns;
  round_ = round;
  round_.notify_all();
}

void Yardstick::lead(const YardstickRules& rules, SimDuration slice) {
  round_ = placed_ = 0;
  std::vector<std::jthread> followers;
  std::int32_t awaited = 0;
  for (std::size_t i = 1; i < rules.loops.size(); ++i) {
    followers.emplace_back([this, loop = rules.loops[i]] { follow(loop); });
    if (rules.loops[i].ends_step) ++awaited;
  }
  take_place(rules.loops.front());
  wait_for(placed_, static_cast<std::int32_t>(followers.size()));
  io_node::SessionClock clock(rules.session, *timing_);
  const SimDuration step = rules.step();
  const std::int64_t grace_ns = duration_of_seconds(rules.session.start_grace).ns;
  const StepIndex not_judged = (grace_ns + step.ns - 1) / step.ns;
  const StepIndex steps = not_judged + slice.ns / step.ns;
  std::int64_t last_ns = monotonic_ns();
  clock.begin(0, last_ns + step.ns);
  StepIndex n = 0;
  for (; n < steps && !is_stopped_; ++n) {
    const std::int64_t due_ns = std::max(clock.due_ns(n), last_ns + step.ns / 2);
    release(static_cast<std::int32_t>(n + 1), due_ns);
    sleep_until_monotonic(due_ns);
    last_ns = monotonic_ns();
    static_cast<void>(clock.keep_time(n, last_ns));
    clock.ran(n, last_ns);
    const YardstickLoop& own = rules.loops.front();
    burn(own.computing);
    wait_for(done_, awaited);
    static_cast<void>(clock.completed(n + 1, n + 1, monotonic_ns()));
    burn(own.work - own.computing);
  }
  clock.close(n, monotonic_ns());
  release(kNoMore, 0);
  followers.clear();
  if (problem_.empty()) problem_ = io_node::problem_of_books(timing_->books.read(), step);
  steps_ += static_cast<std::uint64_t>(n);
  skipped_ += clock.skipped();
  slip_ns_ += clock.slip_ns();
}

void Yardstick::follow(const YardstickLoop& loop) noexcept {
  take_place(loop);
  count_up(placed_);
  std::int32_t round = 0;
  while (true) {
    round_.wait(round);
    round = round_;
    if (round == kNoMore) return;
    sleep_until_monotonic(due_ns_);
    burn(loop.computing);
    if (loop.ends_step) count_up(done_);
    burn(loop.work - loop.computing);
  }
}

wire::Health Yardstick::result() const {
  wire::Health health;
  health.steps_done = steps_;
  health.steps_skipped = skipped_;
  health.slip_ns = slip_ns_;
  health.overruns = timing_->overruns;
  health.longest_overrun = timing_->longest_overrun;
  health.response = node::quantiles_of(timing_->response);
  health.release_jitter = node::quantiles_of(timing_->release_jitter);
  health.cpu_time = node::quantiles_of(timing_->cpu_time);
  return health;
}

}  // namespace slew::analysis
