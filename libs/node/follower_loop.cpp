// SPDX-License-Identifier: Apache-2.0
#include "node/follower_loop.h"

namespace slew::node {

using wire::Role;
using wire::Topic;

bool FollowerLoop::receive_tick(const transport::Received& received, const wire::Header&, StepIndex, std::int64_t) {
  if (!last_tick_.put(received, 0)) {
    ++member_.refusals().undecodable;
    return false;
  }
  tick_flags_ = last_tick_.find(0)->flags;
  if (const TickEnd end = end_of(tick_flags_); end != TickEnd::none) {
    end_ = end;
    last_step_ = last_tick_.find(0)->header.step;
  }
  return false;
}

StepLoop::Next FollowerLoop::next(StepIndex n, std::int64_t, StepInput& input) {
  const StepIndex sample = next_sample(n);
  if (end_ != TickEnd::none && sample > last_step_) return end_ == TickEnd::fault ? Next::wait : Next::end;
  if (!samples_.find(sample, input.partners)) return Next::wait;
  input.released_by = input.used_step = sample;
  return Next::step;
}

void FollowerLoop::collect_missing(StepIndex n, MissingMessages& missing) const noexcept {
  if (is_withheld(member_, next_sample(n) - 1)) return;
  samples_.for_each_missing(next_sample(n), [&](Role role, Topic topic, StepIndex step) {
    missing.push_back({role, topic, step});
  });
}

std::optional<Awaited> FollowerLoop::awaited(StepIndex n) const noexcept {
  if (is_withheld(member_, next_sample(n) - 1)) return std::nullopt;
  return first_missing_sample(member_, samples_, next_sample(n));
}

void FollowerLoop::restart() noexcept {
  tick_flags_ = 0;
  end_ = TickEnd::none;
}

}  // namespace slew::node
