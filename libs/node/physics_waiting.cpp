// SPDX-License-Identifier: Apache-2.0
// PhysicsNode's part that waits: requests for the messages that the next step lacks, the stall watch, and the reaction
// to a node that is silent, gone or at its end.
#include <algorithm>

#include "node/physics_node.h"

namespace slew::node {

using wire::NodeState;
using wire::Phase;
using wire::Role;
using wire::Topic;

namespace {

// ticks and samples that one request names at most
constexpr StepIndex kCatchUp = static_cast<StepIndex>(kRingDepth) - 32;

}  // namespace

void PhysicsNode::update_health() noexcept {
  HealthState& h = health();
  h.state = static_cast<std::uint8_t>(member_.state());
  h.step = n_;
  h.epoch = member_.epoch();
  h.refused = member_.refusals().refused();
  Role missing = Role::io;
  if (loop_ != nullptr && !loop_->lacks_tick(n_)) {
    samples_.for_each_missing(n_, [&](Role role, Topic, StepIndex) { missing = role; });
  }
  h.is_waiting = stage_ == Stage::stepping && resend_.is_overdue();
  h.waiting_for = static_cast<std::uint8_t>(missing);
  h.waiting_step = n_;
  h.has_session.store(member_.has_session(), std::memory_order_release);
}

// In `real` pace the next tick is due one step later. No node waits for a follower: it requests a sample only after the
// time at which that pace brings it.
void PhysicsNode::expect_next(std::int64_t now_ns) noexcept {
  const std::int64_t stride_ns = std::min(samples_.stride() * member_.session().step_ns, kResendAtMost.ns);
  const bool has_time = is_follower() || member_.session().pace == Pace::real;
  resend_.restart(has_time ? now_ns + stride_ns : now_ns);
}

void PhysicsNode::request_missing(std::int64_t now_ns) {
  if (loop_->is_ended_by_fault() || !resend_.is_due(now_ns)) return;
  resend_.requested(now_ns);
  MissingMessages missing;
  if (stage_ == Stage::initialising) {
    samples_.for_each_missing_at_start([&](Role role, Topic topic, StepIndex step) {
      missing.push_back({role, topic, step});
    });
  } else if (stage_ == Stage::loading) {
    missing.push_back({member_.role(), Topic::state, kJoinStep});
  } else {
    loop_->collect_missing(n_, missing);
  }
  for (const Awaited& message : missing) request(message);
}

// While this node computes steps that the other nodes have done, it requests many messages at once.
void PhysicsNode::request(const Awaited& missing) {
  const StepIndex newest = std::min(states_.caught_up_at() - 1, n_ + kCatchUp);
  wire::ResendRequest request;
  request.header = member_.header(Phase::running, missing.step);
  request.role = missing.role;
  request.topic = static_cast<std::uint8_t>(missing.topic);
  request.last_step = stage_ == Stage::stepping ? std::max(missing.step, newest) : missing.step;
  member_.publish(Topic::resend, request);
  ++health().resends_asked;
}

// The first message that the next step lacks, as long as no other node has published the reason.
std::optional<Awaited> PhysicsNode::awaited() const noexcept {
  if (stage_ == Stage::loading) return Awaited{Role::io, Topic::state, n_};
  if (stage_ != Stage::stepping || loop_->is_ended_by_fault()) return std::nullopt;
  // io waits for a node, and ends the session when that takes too long
  const wire::NodeStatus& io = member_.peer(Role::io).status;
  if (io.state == NodeState::holding || io.state >= NodeState::ended) return std::nullopt;
  return loop_->awaited(n_);
}

// io decides first. A node whose messages io does not receive ends by itself a little later.
void PhysicsNode::look_for_stall(std::int64_t now_ns) {
  const bool was_named = stall_.is_named();
  const std::uint64_t requests = health().resends_asked;
  stall_.look(awaited(), requests, now_ns);
  if (was_named && !stall_.is_named() && member_.state() == NodeState::holding && !member_.silent_peer()) {
    member_.set_state(n_ > 0 ? NodeState::running : NodeState::ready);
  }
  if (stall_.begins(member_, now_ns)) {
    if (const std::string text = outrun_text(); !text.empty()) return leave(ExitCode::node_lost, text, now_ns);
    const std::string text = stall_.text(member_, requests);
    if (stall_.may_warn()) member_.warn(text);
    if (stage_ == Stage::stepping) member_.hold(text);
  }
  const SimDuration most{duration_of_seconds(built_.session.stall_timeout).ns + member_.give_up_after().ns};
  if (!stall_.is_named() || stall_.waited() < most) return;
  leave(ExitCode::node_lost,
        stall_.text(member_, requests) + ", nothing came within " + seconds_text(most) +
            " (session.stall_timeout and session.give_up_after); this node stopped after step " + std::to_string(n_),
        now_ns);
}

std::string PhysicsNode::outrun_text() const {
  const Awaited& awaited = stall_.awaited();
  const Peer& writer = member_.peer(awaited.role);
  const SimDuration step{member_.session().step_ns};
  const auto kept = static_cast<StepIndex>(sent_depth(member_.give_up_after(), step));
  const bool is_behind = writer.step_epoch == member_.epoch() && writer.step - awaited.step > kept;
  if (!is_follower() || member_.session().pace != Pace::real || !is_behind) return "";
  return "is " + std::to_string(writer.step - awaited.step) + " steps behind " + std::string(to_text(awaited.role)) +
         ", which keeps the last " + std::to_string(kept) + "; it stopped after step " + std::to_string(n_) +
         ": a sample takes longer than its " + std::to_string(samples_.stride()) +
         " steps; choose a larger recording.every, fewer shapes or triangles, or pace free";
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
  on_peer_event(event, about, now_ns);
}

void PhysicsNode::on_peer_event(PeerEvent event, Role about, std::int64_t now_ns) {
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
