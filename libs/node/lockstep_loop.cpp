// SPDX-License-Identifier: Apache-2.0
#include "node/lockstep_loop.h"

#include <algorithm>

namespace slew::node {

using wire::Role;
using wire::Topic;

bool LockstepLoop::receive_tick(const transport::Received& received, const wire::Header& header, StepIndex n,
                                std::int64_t) {
  return ticks_.keep(received, header.step, n, member_.refusals());
}

StepLoop::Next LockstepLoop::next(StepIndex n, std::int64_t, StepInput& input) {
  const wire::Tick* tick = ticks_.find(n);
  if (tick == nullptr) return Next::wait;
  end_ = end_of(tick->flags);
  if (end_ != TickEnd::none) return end_ == TickEnd::fault ? Next::wait : Next::end;
  if (!samples_.find(n, input.partners)) {
    samples_.for_each_missing(n, [this](Role role, Topic, StepIndex) { timing_.waits_for(role); });
    return Next::wait;
  }
  tick_flags_ = tick->flags;
  input.controls = tick->controls.span();
  input.commands = tick->commands;
  input.released_by = n;
  input.used_step = n - std::max(input.partners.mechanism_age, input.partners.actuators_age);
  return Next::step;
}

void LockstepLoop::collect_missing(StepIndex n, MissingMessages& missing) const noexcept {
  if (lacks_tick(n) && !is_withheld(member_, n)) missing.push_back({Role::io, Topic::tick, n});
  samples_.for_each_missing(n, [&](Role role, Topic topic, StepIndex step) { missing.push_back({role, topic, step}); });
}

std::optional<Awaited> LockstepLoop::awaited(StepIndex n) const noexcept {
  if (is_withheld(member_, n)) return std::nullopt;
  if (!lacks_tick(n)) return first_missing_sample(member_, samples_, n);
  // a tick that io has not sent has its reason there
  const Peer& io = member_.peer(Role::io);
  const bool was_sent = io.step_epoch == member_.epoch() && io.step > n;
  return was_sent ? std::optional(Awaited{Role::io, Topic::tick, n}) : std::nullopt;
}

void LockstepLoop::restart() noexcept {
  ticks_.clear();
  tick_flags_ = 0;
  end_ = TickEnd::none;
}

}  // namespace slew::node
