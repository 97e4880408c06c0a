// SPDX-License-Identifier: Apache-2.0
#include "node/step_loop.h"

#include "node/follower_loop.h"
#include "node/free_loop.h"
#include "node/lockstep_loop.h"

namespace slew::node {

using wire::NodeState;
using wire::Role;
using wire::Topic;

std::unique_ptr<StepLoop> make_step_loop(SessionMember& member, const SampleExchange& samples,
                                         const scene::SessionDef& session, StepTiming& timing) {
  if (transport::traits(member.role()).is_follower) return std::make_unique<FollowerLoop>(member, samples);
  if (session.mode == scene::ExchangeMode::free_running) {
    return std::make_unique<FreeLoop>(member, samples, session.wait_budget_duration());
  }
  return std::make_unique<LockstepLoop>(member, samples, timing);
}

bool is_withheld(const SessionMember& member, StepIndex tick) noexcept {
  const wire::NodeStatus& io = member.peer(Role::io).status;
  if (io.header.epoch != member.epoch()) return false;
  const bool is_paused = io.state == NodeState::holding && io.reason.empty() && io.header.step <= tick;
  return io.state < NodeState::running || is_paused;
}

std::optional<Awaited> first_missing_sample(const SessionMember& member, const SampleExchange& samples,
                                            StepIndex step) noexcept {
  std::optional<Awaited> first;
  samples.for_each_missing(step, [&](Role role, Topic topic, StepIndex of_step) {
    const Peer& partner = member.peer(role);
    // a holding node has published its own reason
    if (!first && !partner.is_lost && partner.status.state != NodeState::holding) first = Awaited{role, topic, of_step};
  });
  return first;
}

}  // namespace slew::node
