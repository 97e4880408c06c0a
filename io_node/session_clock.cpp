// SPDX-License-Identifier: Apache-2.0
#include "io_node/session_clock.h"

#include <algorithm>
#include <utility>

namespace slew::io_node {

using scene::OverrunPolicy;

namespace {

constexpr auto kRelaxed = std::memory_order_relaxed;
// time without a slip after which the machine keeps up again
constexpr std::int64_t kCalmNs = 1'000'000'000;

std::string milliseconds_text(std::int64_t ns) {
  const std::int64_t tenths = (ns + 50'000) / 100'000;
  return std::to_string(tenths / 10) + "." + std::to_string(tenths % 10) + " ms";
}

void add(std::atomic<std::uint64_t>& to, std::uint64_t what) noexcept {
  to.store(to.load(kRelaxed) + what, kRelaxed);
}

// steps due and not done, when the next one is late by `rest`
std::int64_t behind(std::int64_t rest_ns, std::int64_t H) noexcept {
  return rest_ns < 0 ? 0 : rest_ns / H + 1;
}

}  // namespace

void SessionClock::begin(StepIndex n, std::int64_t now_ns) noexcept {
  ran_ = grace_from_ = n;
  grace_slips_ = 0;
  start_ns_ = base_ns_ = now_ns - n * H_;
  excused_ns_ = 0;
  skipped_ = 0;
  complete_ = n;  // its sample is of the start
  slipped_ns_ = 0;
  cpu_ns_ = 0;
  forget_under_way();
  timing_.overrun_run.store(0, kRelaxed);
}

void SessionClock::excuse(StepIndex n, std::int64_t now_ns) noexcept {
  const std::int64_t late_ns = now_ns - due_ns(n);
  if (late_ns <= 0) return;
  excused_ns_ += late_ns;
  base_ns_ += late_ns;
  if (slipped_ns_ != 0) slipped_ns_ += late_ns;
  cpu_ns_ = 0;  // the CPU time in between belongs to no step
}

std::string SessionClock::in_words(const char* what, StepIndex n) const {
  return std::string("session.overrun: ") + what + ": at step " + std::to_string(n) + " ";
}

std::optional<OverrunAction> SessionClock::keep_time(StepIndex n, std::int64_t now_ns) {
  if (grace_slips_ > 0 && is_judged(n)) {
    add(timing_.transitions, 1);
    return OverrunAction{OverrunPolicy::slip,
                         in_words("slip", n) + "the start-up grace (session.start_grace) is over, in which " +
                             std::to_string(std::exchange(grace_slips_, 0)) + " steps of wall time were given up",
                         true};
  }
  const std::int64_t lag_ns = now_ns - due_ns(n);
  if (lag_ns <= longest_lag_ns_) {
    if (slipped_ns_ == 0 || now_ns - slipped_ns_ < kCalmNs) return std::nullopt;
    slipped_ns_ = 0;
    add(timing_.transitions, 1);
    return OverrunAction{OverrunPolicy::slip, in_words("slip", n) +
                                                  "the session has kept up with the wall clock for 1 s again, " +
                                                  std::to_string(skipped_) + " steps were given up so far"};
  }
  const StepIndex steps = policy_ == OverrunPolicy::stop && is_judged(n) ? 0 : give_up(n, lag_ns);
  if (!is_judged(n)) {
    grace_slips_ += steps;
    return OverrunAction{OverrunPolicy::slip, ""};
  }
  if (policy_ != OverrunPolicy::slip) {
    return overrun(n, "the session was " + milliseconds_text(lag_ns) + " behind the wall clock (session.overrun_lag " +
                          milliseconds_text(longest_lag_ns_) + ")");
  }
  const bool is_new = slipped_ns_ == 0;
  slipped_ns_ = now_ns;
  if (!is_new) return OverrunAction{OverrunPolicy::slip, ""};
  add(timing_.transitions, 1);
  return OverrunAction{OverrunPolicy::slip, in_words("slip", n) + "the session was " + milliseconds_text(lag_ns) +
                                                " behind the wall clock; " + std::to_string(steps) +
                                                " steps of wall time were given up"};
}

// In whole steps, of which the first has been due for the whole lag.
StepIndex SessionClock::give_up(StepIndex n, std::int64_t lag_ns) noexcept {
  const StepIndex steps = lag_ns / H_;
  if (is_judged(n) && steps > 0) timing_.add_given_up(lag_ns, SimDuration{H_}, steps);
  base_ns_ += steps * H_;
  all_slips_ns_ += steps * H_;
  skipped_ += static_cast<std::uint64_t>(steps);
  return steps;
}

OverrunAction SessionClock::overrun(StepIndex n, const std::string& why) {
  add(timing_.transitions, 1);
  timing_.overrun_run.store(0, kRelaxed);  // a session that is resumed counts them from 0
  return {policy_, in_words(policy_ == OverrunPolicy::hold ? "hold" : "stop", n) + why};
}

void SessionClock::ran(StepIndex n, std::int64_t now_ns) noexcept {
  ++ran_;
  Issued& tick = issued(n);
  tick = {n, due_ns(n), now_ns, 0};
  const std::int64_t before_ns = cpu_ns_;
  cpu_ns_ = node::thread_cpu_ns();
  if (!is_judged(n)) return;
  timing_.last_release_jitter_ns.store(now_ns - tick.due_ns, kRelaxed);
  if (before_ns != 0) timing_.cpu_time.record(cpu_ns_ - before_ns);
}

void SessionClock::used_input(StepIndex n, std::int64_t came_ns) noexcept {
  if (issued(n).step == n) issued(n).input_ns = came_ns;
}

std::optional<OverrunAction> SessionClock::completed(StepIndex step, StepIndex n, std::int64_t now_ns) {
  std::optional<OverrunAction> action;
  while (complete_ < step) {
    const Issued& tick = issued(complete_++);
    if (tick.step != complete_ - 1) continue;
    if (!is_judged(tick.step)) continue;
    if (tick.input_ns != 0) timing_.input_latency.record(now_ns - tick.input_ns);
    const std::int64_t response_ns = now_ns - tick.due_ns;
    timing_.add_response(response_ns, response_ns > H_);
    timing_.release_jitter.record(tick.sent_ns - tick.due_ns);
    const auto run = static_cast<std::int64_t>(timing_.overrun_run.load(kRelaxed));
    if (policy_ == OverrunPolicy::slip || after_ == 0 || run != after_) continue;
    action = overrun(n, "the last " + std::to_string(run) + " steps were longer than " + milliseconds_text(H_) +
                            " (session.overrun_after), the newest of them " + milliseconds_text(response_ns));
  }
  return action;
}

void SessionClock::close(StepIndex n, std::int64_t now_ns) noexcept {
  const std::int64_t elapsed_ns = now_ns - start_ns_ - excused_ns_;
  const auto due = elapsed_ns < 0 ? 0 : static_cast<std::uint64_t>(elapsed_ns / H_) + 1;
  timing_.books.write({n, due, skipped_, elapsed_ns - n * H_, now_ns - due_ns(ran_)});
}

std::string problem_of_books(const node::SessionBooks& books, SimDuration step) {
  if (books.due == 0) return "";
  const auto skipped = static_cast<std::int64_t>(books.skipped);
  const std::int64_t late = behind(books.rest_ns, step.ns);
  if (static_cast<std::int64_t>(books.due) != books.run + skipped + late) {
    return std::to_string(books.due) + " steps were due, but " + std::to_string(books.run) + " run, " +
           std::to_string(skipped) + " skipped and " + std::to_string(late) + " behind";
  }
  if (books.lag_ns != skipped * step.ns + books.rest_ns) {
    return "a lag of " + std::to_string(books.lag_ns) + " ns, but " + std::to_string(skipped * step.ns) +
           " ns given up and a rest of " + std::to_string(books.rest_ns) + " ns";
  }
  return "";
}

std::string problem_of_books(const wire::Health& io, SimDuration step) {
  return problem_of_books(node::SessionBooks{io.header.step, io.steps_due, io.steps_skipped, io.lag_ns, io.rest_ns},
                          step);
}

std::uint64_t judged_steps_given_up(const wire::Health& io) noexcept {
  return io.response.count - std::min(io.response.count, io.release_jitter.count);
}

}  // namespace slew::io_node
