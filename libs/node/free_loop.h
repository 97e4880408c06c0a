// SPDX-License-Identifier: Apache-2.0
// Free-running: step n is done when tick n has arrived, or when the time at which it was due and the wait budget have
// passed. It uses the partners' samples of step n or, after the budget has passed once more, the newest ones.
//
// Commands of a late tick are applied in the next step. The node is at most the session's window ahead of the newest
// tick.
#pragma once

#include <vector>

#include "node/step_loop.h"

namespace slew::node {

class FreeLoop final : public StepLoop {
 public:
  FreeLoop(SessionMember& member, const SampleExchange& samples, SimDuration wait_budget) noexcept
      : member_(member), samples_(samples), wait_budget_(wait_budget) {}

  bool receive_tick(const transport::Received& received, const wire::Header& header, StepIndex n,
                    std::int64_t now_ns) override;
  Next next(StepIndex n, std::int64_t now_ns, StepInput& input) override;
  [[nodiscard]] bool lacks_tick(StepIndex n) const noexcept override { return ticks_.find(n) == nullptr; }
  // Late ticks only: a late sample is useless, a late command is not.
  void collect_missing(StepIndex n, MissingMessages& missing) const noexcept override;
  [[nodiscard]] std::optional<Awaited> awaited(StepIndex) const noexcept override { return std::nullopt; }
  [[nodiscard]] std::int64_t next_poll_ns(StepIndex n, std::int64_t now_ns,
                                          std::int64_t request_due_ns) const noexcept override;
  [[nodiscard]] bool is_ended_by_fault() const noexcept override { return end_ == TickEnd::fault; }
  [[nodiscard]] bool sheds_variables() const noexcept override {
    return has_flag(tick_flags_, wire::TickFlag::shed_variables);
  }
  void restart() noexcept override;
  void take_over(const wire::SampleState& published) noexcept override;

 private:
  void receive_late(const transport::Received& received);
  [[nodiscard]] bool is_time_over(StepIndex n, std::int64_t now_ns) const noexcept;
  [[nodiscard]] bool waits_for_sample(StepIndex n, StepIndex age, std::int64_t now_ns) noexcept;
  void use_tick(StepIndex n, const wire::Tick* tick, StepInput& input);
  // Time at which tick n is due, counted from the newest one, plus the budget.
  [[nodiscard]] std::int64_t time_limit_ns(StepIndex n) const noexcept;

  static constexpr StepIndex kNoStep = -1;

  SessionMember& member_;
  const SampleExchange& samples_;
  SimDuration wait_budget_;
  TickRing ticks_;
  StepIndex newest_tick_ = kNoStep;             // highest step of a tick that was received
  std::int64_t newest_tick_ns_ = 0;             // time at which it was received
  std::vector<StepIndex> missed_ticks_;         // steps that were done without their tick, ascending
  ReceivedRing<wire::Tick> late_tick_{1};       // the last late tick, as that of step 0
  std::vector<wire::Command> late_commands_;    // commands for the next step
  std::vector<wire::Command> handed_commands_;  // late commands of the step that is being done
  std::vector<double> controls_;                // controls of the newest tick that was used
  std::uint32_t tick_flags_ = 0;                // flags of the same tick
  std::int64_t sample_due_ns_ = 0;              // end of the waiting step's budget; 0: no step waits
  StepIndex used_step_ = kJoinStep;             // step of the newest partner sample that a step used
  std::uint32_t lost_ = 0;                      // partner samples that no step used
  TickEnd end_ = TickEnd::none;
};

}  // namespace slew::node
