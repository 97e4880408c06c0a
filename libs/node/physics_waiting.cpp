// PhysicsNode's part that waits: what the next step lacks, asking for it again, partners that are silent or gone.
#include <algorithm>

#include "node/physics_node.h"

namespace slew::node {

using wire::NodeState;
using wire::Phase;
using wire::Role;
using wire::Topic;

namespace {

// ticks and samples that a node asks for at once when it computes steps that the others have done
constexpr StepIndex kCatchUp = static_cast<StepIndex>(kRingDepth) - 32;

}  // namespace

// io has not sent this tick yet: the session does not tick, or it is paused
bool PhysicsNode::is_withheld(StepIndex tick) const noexcept {
  const wire::NodeStatus& io = member_.peer(Role::io).status;
  if (io.header.epoch != member_.epoch()) return false;
  const bool is_paused = io.state == NodeState::holding && io.reason.empty() && io.header.step <= tick;
  return io.state < NodeState::running || is_paused;
}

void PhysicsNode::ask_for_missing(std::int64_t now_ns) {
  if (is_ended_by_fault_ || !resend_.is_due(now_ns)) return;
  const auto ask = [&](Role role, Topic topic, StepIndex step) {
    wire::ResendRequest request;
    request.header = member_.header(Phase::running, step);
    request.role = role;
    request.topic = static_cast<std::uint8_t>(topic);
    request.last_step = stage_ == Stage::stepping ? std::max(step, std::min(caught_up_at_ - 1, n_ + kCatchUp)) : step;
    member_.publish(Topic::resend, request);
    ++health().resends_asked;
  };
  resend_.asked(now_ns);
  if (stage_ == Stage::initialising) return samples_.for_each_missing_at_start(ask);
  if (stage_ == Stage::loading) return ask(member_.role(), Topic::state, kJoinStep);
  if (is_follower()) {
    if (!is_withheld(n_ + samples_.stride() - 1)) samples_.for_each_missing(n_ + samples_.stride(), ask);
    return;
  }
  if (is_free_running()) {
    // samples are too late by then, commands are not
    for (const StepIndex step : missed_ticks_) ask(Role::io, Topic::tick, step);
    return;
  }
  if (ticks_.find(n_) == nullptr && !is_withheld(n_)) ask(Role::io, Topic::tick, n_);
  samples_.for_each_missing(n_, ask);
}

// The first message that the next step lacks, as long as no other node has published the reason. A free-running node
// waits for none.
std::optional<Awaited> PhysicsNode::awaited() noexcept {
  if (stage_ == Stage::loading) return Awaited{Role::io, Topic::state, n_};
  const wire::NodeStatus& io = member_.peer(Role::io).status;
  if (stage_ != Stage::stepping || is_ended_by_fault_ || is_free_running()) return std::nullopt;
  // io waits for a node, and ends the session when that takes too long
  if (io.state == NodeState::holding || io.state >= NodeState::ended) return std::nullopt;
  const StepIndex next = is_follower() ? n_ + samples_.stride() : n_;
  if (is_withheld(is_follower() ? next - 1 : next)) return std::nullopt;
  if (!is_follower() && ticks_.find(n_) == nullptr) {
    // a tick that io has not sent has its reason there
    const Peer& of_ticks = member_.peer(Role::io);
    const bool was_sent = of_ticks.step_epoch == member_.epoch() && of_ticks.step > n_;
    return was_sent ? std::optional(Awaited{Role::io, Topic::tick, n_}) : std::nullopt;
  }
  std::optional<Awaited> first;
  samples_.for_each_missing(next, [&](Role role, Topic topic, StepIndex step) {
    const Peer& partner = member_.peer(role);
    // a holding node has published its own reason
    if (!first && !partner.is_lost && partner.status.state != NodeState::holding) first = Awaited{role, topic, step};
  });
  return first;
}

// io decides first; a node that io does not hear of ends by itself a little later.
void PhysicsNode::look_for_stall(std::int64_t now_ns) {
  const bool was_named = stall_.is_named();
  const std::uint64_t asked = health().resends_asked;
  stall_.look(awaited(), asked, now_ns);
  if (was_named && !stall_.is_named() && member_.state() == NodeState::holding && !member_.silent_peer()) {
    member_.set_state(n_ > 0 ? NodeState::running : NodeState::ready);
  }
  if (stall_.begins(member_, now_ns)) {
    const std::string text = stall_.text(member_, asked);
    if (stall_.may_warn()) member_.warn(text);
    if (stage_ == Stage::stepping) member_.hold(text);
  }
  const SimDuration most{duration_of_seconds(built_.session.stall_timeout).ns + member_.give_up_after().ns};
  if (!stall_.is_named() || stall_.waited() < most) return;
  leave(ExitCode::node_lost,
        stall_.text(member_, asked) + ", nothing came within " + seconds_text(most) +
            " (session.stall_timeout and session.give_up_after); this node stopped after step " + std::to_string(n_),
        now_ns);
}

void PhysicsNode::watch(std::int64_t now_ns) {
  Role about = Role::io;
  const PeerEvent event = member_.watch_peers(now_ns, about);
  if (stage_ == Stage::leaving) return;
  look_for_stall(now_ns);
  if (stage_ == Stage::leaving) return;
  const Peer& io = member_.peer(Role::io);
  if (io.status.state == NodeState::fault) {
    const auto code = static_cast<ExitCode>(io.status.exit_code);
    const bool by_signal = code == ExitCode::interrupted || code == ExitCode::terminated;
    return leave(code, by_signal ? "" : member_.end_text(Role::io, "io ended the session: " + io.status.reason),
                 now_ns);
  }
  // the END tick normally comes first, and io answers for a while if it was lost
  if (io.status.state == NodeState::ended) {
    if (io_ended_ns_ == 0) io_ended_ns_ = now_ns;
    if (now_ns - io_ended_ns_ > kSilentAfter.ns) leave(ExitCode::ok, "", now_ns);
    return;
  }
  switch (event) {
    case PeerEvent::lost:
      return leave(ExitCode::node_lost,
                   member_.end_text(about, member_.describe_peer(about) + " is gone; this node stopped after step " +
                                               std::to_string(n_)),
                   now_ns);
    case PeerEvent::gone:
      if (stage_ == Stage::stepping) {
        member_.hold(member_.describe_peer(about) + " is gone; waits at step " + std::to_string(n_) +
                     " for another process of its role");
      }
      return;
    case PeerEvent::silent:
      if (stage_ == Stage::stepping) member_.hold(member_.silence_text(about));
      return;
    case PeerEvent::back:
      if (member_.state() != NodeState::holding) return;
      if (const std::optional<Role> silent = member_.silent_peer()) {
        member_.hold(member_.silence_text(*silent));
      } else {
        member_.set_state(n_ > 0 ? NodeState::running : NodeState::ready);
      }
      return;
    case PeerEvent::none:
      return;
  }
}

}  // namespace slew::node
