// SPDX-License-Identifier: Apache-2.0
#include "io_node/sample_progress.h"

#include <algorithm>

#include "node/sample_exchange.h"
#include "transport/roles.h"

namespace slew::io_node {

using wire::Role;

SampleProgress::SampleProgress(const scene::SessionDef& session, StepIndex flexible_every, StepIndex sensor_every,
                               std::uint32_t roles)
    : roles_(roles),
      window_(session.window_steps()),
      ahead_(session.mode == scene::ExchangeMode::free_running ? window_ : 0),
      flexible_every_(flexible_every),
      sensor_every_(sensor_every),
      is_paced_(session.pace == Pace::real) {
  newest_.fill(kJoinStep);
}

SampleProgress::Receipt SampleProgress::receive(Role role, StepIndex step, StepIndex n) noexcept {
  if (step > n + ahead_) return Receipt::too_far_ahead;
  StepIndex& newest = newest_[static_cast<std::size_t>(role)];
  if (step <= newest) return Receipt::repeated;
  const bool is_next = step == newest + 1;
  newest = step;
  return is_next ? Receipt::next : Receipt::later;
}

StepIndex SampleProgress::needed(Role role, StepIndex n) const noexcept {
  if (!transport::traits(role).is_follower) return n - window_ + 1;
  if (role == Role::sensor && is_paced_) return kJoinStep;
  const StepIndex oldest = n - node::kFollowerWindow;
  return oldest < 0 ? kJoinStep : oldest - oldest % (role == Role::sensor ? sensor_every_ : flexible_every_);
}

std::optional<Role> SampleProgress::missing(StepIndex n) const noexcept {
  for (const Role role : transport::physics_roles()) {
    if (is_required(role) && newest(role) < needed(role, n)) return role;
  }
  return std::nullopt;
}

StepIndex SampleProgress::complete_up_to(StepIndex n) const noexcept {
  for (const Role role : transport::physics_roles()) {
    if (is_required(role) && !transport::traits(role).is_follower) n = std::min(n, newest(role));
  }
  return n;
}

std::uint64_t SampleProgress::request_missing(StepIndex n, std::int64_t now_ns, node::SessionMember& member) {
  if (!resend_.is_due(now_ns)) return 0;
  resend_.requested(now_ns);
  std::uint64_t requests = 0;
  for (const Role role : transport::physics_roles()) {
    const StepIndex last = needed(role, n);
    if (!is_required(role) || newest(role) >= last) continue;
    wire::ResendRequest request;
    request.header = member.header(wire::Phase::running, newest(role) + 1);
    request.role = role;
    request.topic = static_cast<std::uint8_t>(transport::traits(role).sample);
    request.last_step = last;
    member.publish(wire::Topic::resend, request);
    ++requests;
  }
  return requests;
}

}  // namespace slew::io_node
