// The books of a session that is paced by the wall clock: which steps were due, done and given up, how late each was,
// and what the session's overrun policy makes of it (docs/realtime.md).
//
// Step n is due at base + n H. `base` is the wall time of step 0, moved by what is no fault of the machine (pauses,
// places that are held, the wait for controllers before the first step: excused) and by what was given up (slips: whole
// steps). At any time, of an epoch,
//
//   steps due = run + skipped + behind       behind: due and not done yet
//   lag       = slips + rest                 lag: wall time since step n was due at first, without what was excused
//
// in whole nanoseconds. The left sides come from the clock and the start alone, the right sides from what was counted:
// ticks as they go out, steps as they are given up. A tick that is counted and does not go out, or the other way round,
// upsets both.
//
// The response of step n goes from the time at which it was due to the arrival of the last sample n+1 that io needs;
// the step overran when that is longer than H, because then Tick n+1 cannot be in time. Steps before the end of the
// start-up grace are not judged.
//
// A step of wall time that is given up after the grace was due and was not there: it overran, and its response is the
// time for which it had been due by then. Whoever is held up for k steps thus has k late responses and not one, and
// the responses are as many as the steps that were due, done or given up; release jitter is of those done alone.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "core/time.h"
#include "node/step_timing.h"
#include "scene/defs.h"

namespace slew::io_node {

// What the policy asks for, and why.
struct OverrunAction {
  scene::OverrunPolicy what = scene::OverrunPolicy::slip;
  std::string why;  // an event: for the recording and the user; empty: nothing to tell
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

  // Step n, the first of an epoch, is due now: 0, or that of a saved state.
  void begin(StepIndex n, std::int64_t now_ns) noexcept;
  // Who computes step n has begun just now: its first steps are not judged either.
  void begin_grace(StepIndex n) noexcept { grace_from_ = n; }
  // The next step n is not due before now: somebody wanted the pause.
  void excuse(StepIndex n, std::int64_t now_ns) noexcept;
  // Nobody judges the steps that are under way: one of their nodes is gone.
  void forget_under_way() noexcept { issued_.fill({}); }
  [[nodiscard]] std::int64_t due_ns(StepIndex n) const noexcept { return base_ns_ + n * H_; }

  // Looks at the lag before step n: gives up whole steps of it, or has the policy's action.
  [[nodiscard]] std::optional<OverrunAction> keep_time(StepIndex n, std::int64_t now_ns);
  // Tick n went out.
  void ran(StepIndex n, std::int64_t now_ns) noexcept;
  // A controller's value that Tick n uses came then.
  void used_input(StepIndex n, std::int64_t came_ns) noexcept;
  // All samples up to `step` have come; those of several steps at once count as come now. n: the next tick.
  [[nodiscard]] std::optional<OverrunAction> completed(StepIndex step, StepIndex n, std::int64_t now_ns);

  // The books as of now, into the node's timing. n: the next tick.
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
  StepIndex grace_from_ = 0;     // the first step of this epoch, or of a process that took a place over
  StepIndex grace_slips_ = 0;    // given up while nobody judged, and not told yet
  StepIndex ran_ = 0;            // the first step of this epoch and as many as went out
  std::int64_t start_ns_ = 0;    // wall time of step 0, as it were when the first step is a later one
  std::int64_t excused_ns_ = 0;  // since then
  std::int64_t base_ns_ = 0;     // start, what was excused and what was given up
  std::uint64_t skipped_ = 0;    // steps of this epoch
  std::int64_t all_slips_ns_ = 0;
  StepIndex complete_ = kJoinStep;
  std::int64_t slipped_ns_ = 0;  // when time was last given up; 0: it is not being given up
  std::int64_t cpu_ns_ = 0;
};

// The two equations above; empty: they hold, or no books were kept, else which does not.
[[nodiscard]] std::string problem_of_books(const node::SessionBooks& books, SimDuration step);
// The same from what io's health says.
[[nodiscard]] std::string problem_of_books(const wire::Health& io, SimDuration step);

// How many of the judged steps were given up, by what io's health says.
[[nodiscard]] std::uint64_t judged_steps_given_up(const wire::Health& io) noexcept;

}  // namespace slew::io_node
