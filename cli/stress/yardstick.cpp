#include "cli/stress/yardstick.h"

#include <pthread.h>
#include <sched.h>

#include <algorithm>

#include "core/real_time_thread.h"

namespace slew::cli {

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
    run(rules, slice);
    is_running_ = false;
  });
}

void Yardstick::wait() {
  if (thread_.joinable()) thread_.join();
}

void Yardstick::run(const YardstickRules& rules, SimDuration slice) {
  if (rules.priority > 0) {
    sched_param parameters{};
    parameters.sched_priority = rules.priority;
    pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters);
  }
  if (rules.cpu >= 0) static_cast<void>(run_on_cpu(rules.cpu));
  io::SessionClock clock(rules.step, rules.overrun, *timing_);
  const StepIndex steps = slice.ns / rules.step.ns;
  std::int64_t last_ns = monotonic_ns();
  clock.begin(0, last_ns + rules.step.ns);
  StepIndex n = 0;
  for (; n < steps && !is_stopped_; ++n) {
    sleep_until_monotonic(std::max(clock.due_ns(n), last_ns + rules.step.ns / 2));
    last_ns = monotonic_ns();
    static_cast<void>(clock.keep_time(n, last_ns));
    clock.ran(n, last_ns);
    burn(rules.work);
    static_cast<void>(clock.completed(n + 1, n + 1, monotonic_ns()));
  }
  clock.close(n, monotonic_ns());
  if (problem_.empty()) problem_ = io::problem_of_books(timing_->books.read(), rules.step);
  steps_ += static_cast<std::uint64_t>(n);
  skipped_ += clock.skipped();
  slip_ns_ += clock.slip_ns();
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

}  // namespace slew::cli
