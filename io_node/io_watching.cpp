// SPDX-License-Identifier: Apache-2.0
// Nodes that have ended, are gone, silent, or publish no more: the session holds their role, or ends.
#include "io_node/io_node.h"
#include "transport/roles.h"

namespace slew::io_node {

using wire::NodeState;
using wire::Role;
using wire::Topic;

// Holds the role of a process that is gone. False: it cannot be replaced, and the session ends.
bool IoNode::hold_role(Role role, std::int64_t now_ns) {
  if (stage_ != Stage::ticking || !keeper_.hold_role(role, n_, samples_, now_ns)) return false;
  clock_.forget_under_way();
  renew_session(n_, now_ns, role);
  show_running();
  return true;
}

// The node that ended first: by its step, then in the order of roles.
const node::Peer* IoNode::first_ended() const noexcept {
  const node::Peer* first = nullptr;
  for (const Role role : transport::node_roles()) {
    if (role == Role::io || !member_.requires_role(role) || keeper_.is_held(role)) continue;
    const node::Peer& peer = member_.peer(role);
    if (!peer.is_known || peer.status.state < NodeState::ended) continue;
    if (first == nullptr || peer.status.header.step < first->status.header.step) first = &peer;
  }
  return first;
}

void IoNode::watch(std::int64_t now_ns) {
  if (stage_ == Stage::checking_name || stage_ == Stage::finished) return;
  Role about = Role::io;
  const node::PeerEvent event = member_.watch_peers(now_ns, about);
  if (stage_ == Stage::ending) return;
  for (const StateKeeper::HeldChange& change : keeper_.watch_held(n_, now_ns)) {
    using Kind = StateKeeper::HeldChange::Kind;
    if (change.kind == Kind::rejected) renew_session(n_, now_ns, change.role);
    if (change.kind == Kind::filled) show_running();
    if (change.kind == Kind::expired) return begin_ending(ExitCode::node_lost, change.reason, now_ns);
  }
  const node::Peer* first = first_ended();
  // a node may have reported a loss a moment before io detects it
  const bool reports_loss = first != nullptr && static_cast<ExitCode>(first->status.exit_code) == ExitCode::node_lost;
  const bool sees_loss = event == node::PeerEvent::gone || event == node::PeerEvent::lost;
  if (first != nullptr && !(reports_loss && sees_loss)) {
    if (fault_seen_ns_ == 0) fault_seen_ns_ = now_ns;
    if (now_ns - fault_seen_ns_ < (reports_loss ? kLossGathering : kFaultGathering).ns) return;
    const Role role = first->status.header.role;
    return begin_ending(static_cast<ExitCode>(first->status.exit_code),
                        member_.end_text(role, member_.describe_peer(role) + ": " + first->status.reason), now_ns);
  }
  switch (event) {
    case node::PeerEvent::gone:
      if (hold_role(about, now_ns)) return;
      [[fallthrough]];
    case node::PeerEvent::lost:
      return begin_ending(
          ExitCode::node_lost,
          member_.end_text(about, member_.describe_peer(about) + " is gone; the session was held after step " +
                                      std::to_string(n_) + " and ended, what was recorded up to there is valid"),
          now_ns);
    case node::PeerEvent::silent:
      if (stage_ == Stage::ticking) member_.hold(member_.silence_text(about));
      return;
    case node::PeerEvent::back:
      if (stage_ == Stage::ticking) show_running();
      return;
    case node::PeerEvent::none:
      return;
  }
}

// The next tick lacks a message. Its writer is named after 0.3 s; after session.stall_timeout its role is held for a
// replacement, or the session ends. The recorder may wait for its disk for any time.
void IoNode::watch_stall(std::int64_t now_ns) {
  std::optional<node::Awaited> awaited;
  if (const std::optional<Role> role = samples_.missing(n_)) {
    awaited = {*role, transport::traits(*role).sample, samples_.newest(*role) + 1};
  } else {
    awaited = {Role::recorder, Topic::node_status, n_};
  }
  if (keeper_.is_holding()) awaited.reset();  // the status names the held role
  const std::uint64_t requests = health().resends_asked;
  stall_.look(awaited, requests, now_ns);
  if (stall_.begins(member_, now_ns)) {
    if (stall_.may_warn()) member_.warn(stall_.text(member_, requests));
    show_running();
  }
  const SimDuration longest = duration_of_seconds(config_.session.stall_timeout);
  if (!stall_.is_named() || stall_.waited() < longest || stall_.awaited().role == Role::recorder) return;
  const std::string text = stall_.text(member_, requests);
  if (config_.session.rejoin > 0 && hold_role(stall_.awaited().role, now_ns)) {
    member_.warn(text + " for " + seconds_text(longest) + "; its place was given away");
    return;
  }
  begin_ending(ExitCode::node_lost,
               text + ", nothing came within " + seconds_text(longest) +
                   " (session.stall_timeout); the session was held after step " + std::to_string(n_) +
                   " and ended, what was recorded up to there is valid; look for a filter or tunnel that drops some "
                   "datagrams",
               now_ns);
}

// The next tick lacks no message, or is held for another reason.
void IoNode::end_stall(std::int64_t now_ns) {
  const bool was_named = stall_.is_named();
  stall_.look(std::nullopt, health().resends_asked, now_ns);
  if (was_named) show_running();
}

}  // namespace slew::io_node
