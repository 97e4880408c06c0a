// SPDX-License-Identifier: Apache-2.0
// A follower (flex) has no state to advance: the sample of a step follows from the mechanics' sample of the same step.
// It needs no tick. Ticks give it the last step of the session and the order to shed the values of its variables.
#pragma once

#include "node/step_loop.h"

namespace slew::node {

class FollowerLoop final : public StepLoop {
 public:
  FollowerLoop(SessionMember& member, const SampleExchange& samples) noexcept : member_(member), samples_(samples) {}

  // False: the mechanics' samples release the steps of a follower.
  bool receive_tick(const transport::Received& received, const wire::Header& header, StepIndex n,
                    std::int64_t now_ns) override;
  Next next(StepIndex n, std::int64_t now_ns, StepInput& input) override;
  [[nodiscard]] bool lacks_tick(StepIndex) const noexcept override { return false; }
  void collect_missing(StepIndex n, MissingMessages& missing) const noexcept override;
  [[nodiscard]] std::optional<Awaited> awaited(StepIndex n) const noexcept override;
  [[nodiscard]] bool is_ended_by_fault() const noexcept override { return end_ == TickEnd::fault; }
  [[nodiscard]] bool sheds_variables() const noexcept override {
    return has_flag(tick_flags_, wire::TickFlag::shed_view) || has_flag(tick_flags_, wire::TickFlag::shed_variables);
  }
  void restart() noexcept override;

 private:
  // Step of the next own sample, and of the mechanics' sample that it needs.
  [[nodiscard]] StepIndex next_sample(StepIndex n) const noexcept { return n + samples_.stride(); }

  SessionMember& member_;
  const SampleExchange& samples_;
  ReceivedRing<wire::Tick> last_tick_{1};  // as that of step 0; a member so that its memory is kept
  std::uint32_t tick_flags_ = 0;           // flags of the last tick that could be decoded
  TickEnd end_ = TickEnd::none;
  StepIndex last_step_ = 0;  // last step of the session, once end_ is known
};

}  // namespace slew::node
