// SPDX-License-Identifier: Apache-2.0
// Books of a session that is paced by the wall clock: the steps that were due, done and given up, the lateness of each,
// and the action of the session's overrun policy (docs/realtime.md).
//
// Step n is due at base + n H. `base` is the wall time of step 0, moved by excused times (pauses, held roles, the wait
// for controllers before the first step) and by slips (whole steps that were given up). At any time of an epoch
//
//   steps due = run + skipped + behind       behind: due and not done yet
//   lag       = slips + rest                 lag: wall time since step n was first due, without excused times
//
// in whole nanoseconds. The left sides come from the clock and the start alone, the right sides from counts: ticks that
// go out, steps that are given up. A tick that is counted and does not go out, or the reverse, upsets both.
//
// The response of step n goes from the time at which it was due to the arrival of the last sample n+1 that io needs;
// the step overran when that is longer than H, because then Tick n+1 cannot be in time. Steps before the end of the
// start-up grace are not judged.
//
// A step of wall time that is given up after the grace was due and not done: it overran, and its response is the time
// for which it had been due. A machine that stalls for k steps thus has k late responses instead of one, and there are
// as many responses as steps that were due, done or given up; release jitter counts the steps that were done alone.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "core/time.h"
#include "node/step_timing.h"
#include "scene/defs.h"

namespace slew::io_node {

// Action of the policy, and its reason.
struct OverrunAction {
  scene::OverrunPolicy what = scene::OverrunPolicy::slip;
  std::string why;  // event for the recording and the user; empty: none
  bool is_for_recording_alone = false;
};

class SessionClock {
 public:
  // The session's step, overrun policy with its limits, and start-up grace.
  SessionClock(const scene::SessionDef& session, node::NodeTiming& timing)
      : H_(session.step_duration().ns),
        policy_(session.overrun),
        after_(session.overrun_after),
        longest_lag_ns_(duration_of_seconds(session.overrun_lag).ns),
        grace_ns_(duration_of_seconds(session.start_grace).ns),
        timing_(timing) {}

  // Step n, the first of an epoch, is due now: step 0, or that of a saved state.
  void begin(StepIndex n, std::int64_t now_ns) noexcept;
  // A replacement computes from step n on: its first steps are not judged either.
  void begin_grace(StepIndex n) noexcept { grace_from_ = n; }
  // The next step n is not due before now: the hold was requested.
  void excuse(StepIndex n, std::int64_t now_ns) noexcept;
  // The steps that are under way are not judged: one of their nodes is gone.
  void forget_under_way() noexcept { issued_.fill({}); }
  [[nodiscard]] std::int64_t due_ns(StepIndex n) const noexcept { return base_ns_ + n * H_; }

  // Compares the lag before step n with the limit: gives up whole steps, or returns the policy's action.
  [[nodiscard]] std::optional<OverrunAction> keep_time(StepIndex n, std::int64_t now_ns);
  // Tick n went out.
  void ran(StepIndex n, std::int64_t now_ns) noexcept;
  // Arrival of the oldest controller's value that Tick n uses.
  void used_input(StepIndex n, std::int64_t came_ns) noexcept;
  // All samples up to `step` are there; those of several steps at once count as received now. n: the next tick.
  [[nodiscard]] std::optional<OverrunAction> completed(StepIndex step, StepIndex n, std::int64_t now_ns);

  // Writes the present books into the node's timing. n: the next tick.
  void close(StepIndex n, std::int64_t now_ns) noexcept;
  [[nodiscard]] bool is_judged(StepIndex n) const noexcept { return (n - grace_from_) * H_ >= grace_ns_; }
  [[nodiscard]] std::int64_t slip_ns() const noexcept { return all_slips_ns_; }
  [[nodiscard]] std::uint64_t skipped() const noexcept { return skipped_; }

 private:
  static constexpr std::size_t kDepth = 1024;  // ticks that may be under way
  struct Issued {
    StepIndex step = -1;
    std::int64_t due_ns = 0, sent_ns = 0, input_ns = 0;
  };

  [[nodiscard]] Issued& issued(StepIndex n) noexcept { return issued_[static_cast<std::size_t>(n) % kDepth]; }
  [[nodiscard]] std::string in_words(const char* what, StepIndex n) const;
  StepIndex give_up(StepIndex n, std::int64_t lag_ns) noexcept;
  // The action of `hold` or `stop`.
  [[nodiscard]] OverrunAction overrun(StepIndex n, const std::string& why);

  std::int64_t H_;
  scene::OverrunPolicy policy_;
  std::int64_t after_;  // consecutive overruns; 0: the lag alone decides
  std::int64_t longest_lag_ns_, grace_ns_;
  node::NodeTiming& timing_;
  std::array<Issued, kDepth> issued_{};
  StepIndex grace_from_ = 0;     // first step of this epoch, or of a replacement
  StepIndex grace_slips_ = 0;    // given up in the grace, and not reported yet
  StepIndex ran_ = 0;            // first step of this epoch plus the ticks that went out
  std::int64_t start_ns_ = 0;    // wall time of step 0, computed back if the first step is a later one
  std::int64_t excused_ns_ = 0;  // since then
  std::int64_t base_ns_ = 0;     // start, with excused times and slips
  std::uint64_t skipped_ = 0;    // steps of this epoch
  std::int64_t all_slips_ns_ = 0;
  StepIndex complete_ = kJoinStep;
  std::int64_t slipped_ns_ = 0;  // time of the last slip; 0: the session keeps up
  std::int64_t cpu_ns_ = 0;
};

// The equation above that does not hold; empty: both hold, or no books were kept.
[[nodiscard]] std::string problem_of_books(const node::SessionBooks& books, SimDuration step);
// The same from io's health.
[[nodiscard]] std::string problem_of_books(const wire::Health& io, SimDuration step);

// Number of judged steps that were given up, from io's health.
[[nodiscard]] std::uint64_t judged_steps_given_up(const wire::Health& io) noexcept;

}  // namespace slew::io_node
