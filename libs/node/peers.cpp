// SPDX-License-Identifier: Apache-2.0
// What a member receives of its peers' life, and the sentences about peers that are silent, gone or lost.
#include "node/session_member.h"
#include "transport/roles.h"

namespace slew::node {

using wire::NodeState;
using wire::Role;

void SessionMember::on_health(std::span<const std::byte> bytes, std::int64_t now_ns) {
  wire::Health health;
  if (!transport::decode(bytes, health) || !has_session_ || health.header.session != session_.header.session) return;
  if (static_cast<std::size_t>(health.header.role) >= wire::kRoles) return;
  Peer& peer = peers_[health.header.role];
  if (peer.incarnation != health.header.incarnation) return;
  peer.last_received_ns = now_ns;
  peer.step = health.header.step;
  peer.step_epoch = health.header.epoch;
}

PeerEvent SessionMember::watch_peers(std::int64_t now_ns, Role& about) {
  peers_.begin_look(give_up_after(), now_ns);
  for (const Role role : transport::node_roles()) {
    if (role == role_ || !requires_role(role)) continue;
    if (!peer(role).is_known || peer(role).status.state >= NodeState::ended) continue;
    about = role;
    if (const PeerEvent event = peers_.look_at(role, session_, now_ns); event != PeerEvent::none) return event;
  }
  return PeerEvent::none;
}

std::optional<Role> SessionMember::silent_peer() const noexcept {
  for (const Role role : transport::node_roles()) {
    const Peer& peer = this->peer(role);
    if (requires_role(role) && peer.is_silent && !peer.is_lost && peer.status.state < NodeState::ended) return role;
  }
  return std::nullopt;
}

std::string SessionMember::describe_peer(Role role) const {
  const Peer& peer = this->peer(role);
  std::string text(to_text(role));
  if (!peer.is_known) return text;
  return text + " (process " + std::to_string(peer.status.pid) + " on " + machine_of(peer.status.host) + ")";
}

std::string SessionMember::silence_text(Role role) const {
  return "waits for " + describe_peer(role) + ", which has been silent for 0.3 s at step " +
         std::to_string(status_.header.step) + "; it is given up after " + give_up_text();
}

std::string SessionMember::give_up_text() const {
  return seconds_text(give_up_after()) + " (session.give_up_after)";
}

std::string SessionMember::end_text(Role about, const std::string& reason) const {
  const Peer& peer = this->peer(about);
  const std::string own_loss = std::string(to_text(role_)) + " (process " + std::to_string(identity_.pid) + " on " +
                               machine_of(identity_.host) + ") is gone";
  const bool is_given_up = peer.status.reason.find(own_loss) != std::string::npos;
  const bool has_stood_still = peers_.stood_still().ns > 0;
  const std::string stood_still =
      "stood still for " + seconds_text(peers_.stood_still()) + (peers_.stood_sending() ? " while it sent" : "");
  // a process that was stopped may have been sending just then
  const std::string remedy =
      std::string("; look for what stopped the process (a signal, a debugger, lack of memory or of processors)") +
      (peers_.stood_sending() ? " or took nothing from it (a cable that is out, an interface that is down)" : "");
  if (is_given_up && has_stood_still) {
    return "this node " + stood_still + " at step " + std::to_string(status_.header.step) + " and was given up after " +
           give_up_text() + "; session '" + session_.name + "' has ended" + remedy;
  }
  if (is_given_up) {
    return "this node ran, but its messages did not arrive for " + give_up_text() +
           " and it was given up; check the network from this machine to the others; " + reason;
  }
  // the peers may have given this node up and exited
  if (peer.is_lost && has_stood_still && peers_.since_stood_still().ns <= session_.give_up_ns + linger().ns) {
    return reason + "; this node itself had " + stood_still + ", and after " + give_up_text() +
           " the others give a node up" + remedy;
  }
  return reason;
}

}  // namespace slew::node
