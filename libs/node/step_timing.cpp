// SPDX-License-Identifier: Apache-2.0
#include "node/step_timing.h"

#include <time.h>

#include <algorithm>
#include <utility>

namespace slew::node {
namespace {

constexpr auto kRelaxed = std::memory_order_relaxed;
// a message is in flight for no longer than its writer may be silent
constexpr std::int64_t kLongestFlightNs = 2'000'000'000;

double seconds(std::int64_t ns) noexcept {
  return static_cast<double>(ns) * 1e-9;
}

// one writer
template <typename T>
void add(std::atomic<T>& to, T what) noexcept {
  to.store(to.load(kRelaxed) + what, kRelaxed);
}

}  // namespace

void NodeTiming::add_response(std::int64_t ns, bool is_late) noexcept {
  last_response_ns.store(ns, kRelaxed);
  response.record(ns);
  note_recent(ns);
  if (is_late)
    add_overruns(1);
  else
    overrun_run.store(0, kRelaxed);
}

void NodeTiming::add_given_up(std::int64_t first_due_for_ns, SimDuration step, StepIndex steps) noexcept {
  response.record_falling(first_due_for_ns, step.ns, static_cast<std::uint64_t>(steps));
  note_recent(first_due_for_ns);
  add_overruns(steps);
}

void NodeTiming::note_recent(std::int64_t response_ns) noexcept {
  // if the reader resets it meanwhile, this step's response is the largest since
  if (response_ns > response_recent_ns.load(kRelaxed)) response_recent_ns.store(response_ns, kRelaxed);
}

void NodeTiming::add_overruns(StepIndex steps) noexcept {
  add<std::uint64_t>(overruns, static_cast<std::uint64_t>(steps));
  add<std::uint64_t>(overrun_run, static_cast<std::uint64_t>(steps));
  longest_overrun.store(std::max(longest_overrun.load(kRelaxed), overrun_run.load(kRelaxed)), kRelaxed);
}

wire::Quantiles quantiles_of(const HdrHistogram& histogram) noexcept {
  wire::Quantiles quantiles;
  quantiles.count = histogram.count();
  quantiles.least = seconds(histogram.min());
  constexpr std::array<double, 3> kShares = {0.5, 0.99, 0.999};
  std::array<std::int64_t, 3> values{};
  histogram.percentiles(kShares, values);
  quantiles.p50 = seconds(values[0]);
  quantiles.p99 = seconds(values[1]);
  quantiles.p999 = seconds(values[2]);
  quantiles.largest = seconds(histogram.max());
  return quantiles;
}

std::int64_t thread_cpu_ns() noexcept {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return std::int64_t{t.tv_sec} * 1'000'000'000 + t.tv_nsec;
}

std::int64_t sent_ns(std::int64_t source_wall_ns, std::int64_t now_ns, WriterClock clock) noexcept {
  if (clock == WriterClock::other) return now_ns;
  const std::int64_t flight_ns = wall_clock_ns() - source_wall_ns;
  return flight_ns >= 0 && flight_ns <= kLongestFlightNs ? now_ns - flight_ns : now_ns;
}

void StepTiming::release(StepIndex step, std::int64_t released_ns, std::int64_t in_hand_ns) noexcept {
  releases_[static_cast<std::size_t>(step) % kDepth] = {step, released_ns, in_hand_ns};
}

void StepTiming::begin(StepIndex step) noexcept {
  step_ = step;
  begin_ns_ = monotonic_ns();
  const Release& released = releases_[static_cast<std::size_t>(step) % kDepth];
  // a free-running step may be done without its tick
  release_ = released.step == step ? released : Release{step, begin_ns_, begin_ns_};
}

std::int64_t StepTiming::computed() noexcept {
  computed_ns_ = monotonic_ns();
  return computed_ns_ - begin_ns_;
}

bool StepTiming::is_late() const noexcept {
  return deadline_ns_ > 0 && step_ >= first_ && computed_ns_ - release_.released_ns > deadline_ns_;
}

// Delay of the release by the partner whose sample arrived last, as it delays every tick: from the time at which the
// release was due or, without a pace, from the end of the step before.
std::int64_t StepTiming::held_back_ns() const noexcept {
  const std::int64_t due_ns = deadline_ns_ > 0 ? std::max(published_ns_, released_ns_ + deadline_ns_) : published_ns_;
  return std::max<std::int64_t>(0, std::min(came_.ns, release_.in_hand_ns) - due_ns);
}

// The clock is read after the first step, then after each step or kCpuSteps of them.
void StepTiming::measure_cpu_time() noexcept {
  const bool is_first = published_ns_ == 0;
  if (!is_first && ++cpu_steps_ < (deadline_ns_ > 0 ? 1 : kCpuSteps)) return;
  const std::int64_t now_ns = thread_cpu_ns();
  if (!is_first && step_ >= first_) timing_.cpu_time.record((now_ns - cpu_ns_) / cpu_steps_);
  cpu_ns_ = now_ns;
  cpu_steps_ = 0;
}

void StepTiming::published() noexcept {
  const std::int64_t now_ns = monotonic_ns();
  measure_cpu_time();
  const std::int64_t before_ns = published_ns_, held_ns = held_back_ns();
  published_ns_ = now_ns;
  released_ns_ = release_.released_ns;
  const wire::Role partner = std::exchange(partner_, wire::Role::io);
  if (step_ < first_) return;
  timing_.release_jitter.record(release_.in_hand_ns - release_.released_ns);
  timing_.last_release_jitter_ns.store(release_.in_hand_ns - release_.released_ns, kRelaxed);
  timing_.execution.record(computed_ns_ - begin_ns_);
  if (before_ns != 0) {
    timing_.wait.record(begin_ns_ - before_ns);
    // until the release the node waits for io, from then on for the partner whose sample arrived last
    const std::int64_t to_io_ns =
        partner == wire::Role::io ? begin_ns_ - before_ns
                                  : std::clamp<std::int64_t>(release_.in_hand_ns - before_ns, 0, begin_ns_ - before_ns);
    const std::int64_t of_partner_ns = std::min(held_ns, to_io_ns);
    add(timing_.waited_ns[0], to_io_ns - of_partner_ns);
    add(timing_.waited_ns[static_cast<std::size_t>(came_.partner)], of_partner_ns);
    if (partner != wire::Role::io) {
      add(timing_.waited_ns[static_cast<std::size_t>(partner)], begin_ns_ - before_ns - to_io_ns);
    }
  }
  const std::int64_t response_ns = now_ns - release_.released_ns;
  timing_.add_response(response_ns, deadline_ns_ > 0 && response_ns > deadline_ns_);
}

void StepTiming::restart() noexcept {
  releases_.fill({});
  published_ns_ = 0;
  cpu_steps_ = 0;
}

}  // namespace slew::node
