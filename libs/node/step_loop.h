// SPDX-License-Identifier: Apache-2.0
// Decides when the next step of a physics node can be done, and selects its inputs. A node runs one loop for the
// session:
//
//   LockstepLoop  step n needs tick n and the samples of all partners
//   FreeLoop      step n needs tick n, or the time at which it was due and the wait budget; it uses the newest samples
//   FollowerLoop  the next sample needs the mechanics' sample of the same step; ticks give only the end and the load
//
// The order in which messages arrive has no influence in lock-step: each message is used at its step. `n` is the next
// step to do. No function allocates once the loop has its memory, except for a late tick and for longer lists of
// commands.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "core/static_vector.h"
#include "coupling/subsystem.h"
#include "node/sample_exchange.h"
#include "node/session_member.h"
#include "node/stall_watch.h"
#include "node/step_timing.h"
#include "node/subsystem_factory.h"

namespace slew::node {

// Inputs of one step. Pointers and spans hold until the next call of the loop.
struct StepInput {
  coupling::PartnerSamples partners;
  std::span<const double> controls;              // by input channel
  std::span<const wire::Command> late_commands;  // from late ticks; applied before `commands`
  std::span<const wire::Command> commands;
  StepIndex released_by = 0;        // step of the message that released this step
  StepIndex used_step = kJoinStep;  // step of the partner's sample
  std::uint32_t lost = 0;           // partner samples that no step used, so far
  coupling::Quality quality = coupling::Quality::ok;
};

// Capacity: a ring of ticks and one sample of each topic.
using MissingMessages = StaticVector<Awaited, kRingDepth + wire::kTopics>;

class StepLoop {
 public:
  // wait: a message or the time is missing, or the session ended by a fault, whose reason io publishes in its status.
  // step: `input` is filled in. end: the session ends before this step.
  enum class Next : std::uint8_t { wait, step, end };

  virtual ~StepLoop() = default;

  // Takes a running tick of the present epoch. True when the tick releases a step that is still to be done.
  virtual bool receive_tick(const transport::Received& received, const wire::Header& header, StepIndex n,
                            std::int64_t now_ns) = 0;
  // Pre-condition: `input` is as constructed. A loop that returns `step` takes the step for done.
  virtual Next next(StepIndex n, std::int64_t now_ns, StepInput& input) = 0;

  // The tick that releases step n is missing.
  [[nodiscard]] virtual bool lacks_tick(StepIndex n) const noexcept = 0;
  // Appends the messages to request from their writers. A tick that io withholds is not among them.
  virtual void collect_missing(StepIndex n, MissingMessages& missing) const noexcept = 0;
  // The first message without which the step is not done although its writer has published it; none: the step waits
  // for no message, or the reason of the wait is published in the status of another node.
  [[nodiscard]] virtual std::optional<Awaited> awaited(StepIndex n) const noexcept = 0;
  // Monotonic time of the next poll when no message arrives. Parameters: n, the present time, that of the next request.
  [[nodiscard]] virtual std::int64_t next_poll_ns(StepIndex, std::int64_t, std::int64_t request_due_ns) const noexcept {
    return request_due_ns;
  }

  // A tick announced that the session ends by a fault: no message is requested any more.
  [[nodiscard]] virtual bool is_ended_by_fault() const noexcept = 0;
  // The newest tick that was used orders this node to publish no values of its variables.
  [[nodiscard]] virtual bool sheds_variables() const noexcept = 0;

  // A new epoch begins.
  virtual void restart() noexcept = 0;
  // Continues from a state of the session. The argument is the state in the sample of that step.
  virtual void take_over(const wire::SampleState&) noexcept {}
};

// The loop of the role and of the session's mode. The arguments outlive it.
[[nodiscard]] std::unique_ptr<StepLoop> make_step_loop(SessionMember& member, const SampleExchange& samples,
                                                       const scene::SessionDef& session, StepTiming& timing);

// ---- parts of several loops -------------------------------------------------------------------------------------

// The ticks that a node still needs, by step.
class TickRing {
 public:
  // Keeps the tick of a step that is still to be done, once. n: the next step to do. False: the tick was dropped and
  // counted in `refusals`.
  bool keep(const transport::Received& received, StepIndex step, StepIndex n, Refusals& refusals) {
    ring_.drop_before(n);
    if (step >= n + static_cast<StepIndex>(kRingDepth)) {
      ++refusals.too_far_ahead;
    } else if (step < n || ring_.find(step) != nullptr) {
      ++refusals.duplicate;
    } else if (!ring_.put(received, step)) {
      ++refusals.undecodable;
    } else {
      return true;
    }
    return false;
  }
  [[nodiscard]] const wire::Tick* find(StepIndex step) const noexcept { return ring_.find(step); }
  void clear() noexcept { ring_.clear(); }

 private:
  ReceivedRing<wire::Tick> ring_{kRingDepth};
};

// fault: the session ends for an error; the status of io gives the reason.
enum class TickEnd : std::uint8_t { none, regular, fault };

[[nodiscard]] constexpr bool has_flag(std::uint32_t flags, wire::TickFlag flag) noexcept {
  return (flags & static_cast<std::uint32_t>(flag)) != 0;
}

[[nodiscard]] constexpr TickEnd end_of(std::uint32_t flags) noexcept {
  if (!has_flag(flags, wire::TickFlag::end)) return TickEnd::none;
  return has_flag(flags, wire::TickFlag::fault) ? TickEnd::fault : TickEnd::regular;
}

// io has not sent this tick: the session has not begun to tick, or it is paused.
[[nodiscard]] bool is_withheld(const SessionMember& member, StepIndex tick) noexcept;

// The first missing sample of a step whose writer is present and holds for no other node.
[[nodiscard]] std::optional<Awaited> first_missing_sample(const SessionMember& member, const SampleExchange& samples,
                                                          StepIndex step) noexcept;

}  // namespace slew::node
