// SPDX-License-Identifier: Apache-2.0
// Lock-step: step n is done with tick n and the partners' samples that hold at step n, however late they come.
#pragma once

#include "node/step_loop.h"

namespace slew::node {

class LockstepLoop final : public StepLoop {
 public:
  LockstepLoop(SessionMember& member, const SampleExchange& samples, StepTiming& timing) noexcept
      : member_(member), samples_(samples), timing_(timing) {}

  bool receive_tick(const transport::Received& received, const wire::Header& header, StepIndex n,
                    std::int64_t now_ns) override;
  Next next(StepIndex n, std::int64_t now_ns, StepInput& input) override;
  [[nodiscard]] bool lacks_tick(StepIndex n) const noexcept override { return ticks_.find(n) == nullptr; }
  void collect_missing(StepIndex n, MissingMessages& missing) const noexcept override;
  [[nodiscard]] std::optional<Awaited> awaited(StepIndex n) const noexcept override;
  [[nodiscard]] bool is_ended_by_fault() const noexcept override { return end_ == TickEnd::fault; }
  [[nodiscard]] bool sheds_variables() const noexcept override {
    return has_flag(tick_flags_, wire::TickFlag::shed_variables);
  }
  void restart() noexcept override;

 private:
  SessionMember& member_;
  const SampleExchange& samples_;
  StepTiming& timing_;
  TickRing ticks_;
  std::uint32_t tick_flags_ = 0;  // flags of the last used tick
  TickEnd end_ = TickEnd::none;   // set once the END tick is the next one
};

}  // namespace slew::node
