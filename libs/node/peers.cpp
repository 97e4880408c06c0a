// SPDX-License-Identifier: Apache-2.0
// Peers that are silent, gone or lost, and the sentences about them.
#include <algorithm>
#include <utility>

#include "node/session_member.h"
#include "transport/roles.h"

namespace slew::node {

using wire::NodeState;
using wire::Role;

void SessionMember::on_health(std::span<const std::byte> bytes, std::int64_t now_ns) {
  wire::Health health;
  if (!transport::decode(bytes, health) || !has_session_ || health.header.session != session_.header.session) return;
  const auto index = static_cast<std::size_t>(health.header.role);
  if (index < wire::kRoles && peers_[index].incarnation == health.header.incarnation) {
    peers_[index].last_received_ns = now_ns;
    peers_[index].step = health.header.step;
    peers_[index].step_epoch = health.header.epoch;
  }
}

bool SessionMember::may_be_replaced(Role role) const noexcept {
  return transport::is_physics(role) && session_.rejoin_ns > 0;
}

void SessionMember::excuse_peers(std::int64_t now_ns) noexcept {
  const std::int64_t gap_ns = watched_ns_ == 0 ? 0 : now_ns - watched_ns_;
  watched_ns_ = now_ns;
  // time spent in sending after the last check read the clock counts too
  const std::int64_t sending_ns = sending_ns_ + std::exchange(sent_before_ns_, sending_ns_);
  sending_ns_ = 0;
  if (gap_ns <= kUsualLook.ns) return;
  if (gap_ns > session_.give_up_ns) {
    stood_still_ns_ = gap_ns;
    stood_until_ns_ = now_ns;
    stood_sending_ = sending_ns > gap_ns / 2;
  }
  // a long gap is excused once, since a peer may have ended in it; each shorter one, since a part of it still counts
  const bool is_long = gap_ns > kStoodStill.ns;
  for (Peer& peer : peers_) {
    if (is_long && peer.last_received_ns == peer.excused_ns) continue;
    const bool was_excused = peer.last_received_ns == peer.excused_ns;
    peer.last_received_ns = std::min(now_ns, peer.last_received_ns + gap_ns - (is_long ? 0 : kUsualLook.ns));
    if (is_long || was_excused) peer.excused_ns = peer.last_received_ns;
  }
}

PeerEvent SessionMember::look_at(Peer& peer, Role role, std::int64_t now_ns) noexcept {
  const std::int64_t silent_ns = now_ns - peer.last_received_ns;
  // its last message, with the reason, may be in flight
  const bool is_gone = peer.exit_seen_ns != 0 && now_ns - peer.exit_seen_ns >= kInFlight.ns;
  if (peer.gone_ns != 0) {
    // io decides about its place; a peer whose messages arrive again was cut off from this process only
    if (!is_gone && silent_ns <= kSilentAfter.ns) {
      peer.gone_ns = 0;
      peer.is_lost = peer.is_silent = false;
      return PeerEvent::back;
    }
    if (now_ns - peer.gone_ns <= session_.rejoin_ns + session_.give_up_ns) return PeerEvent::none;
    peer.gone_ns = 0;
    return PeerEvent::lost;
  }
  if (peer.is_lost) return PeerEvent::none;
  if (is_gone || silent_ns > session_.give_up_ns) {
    peer.is_lost = true;
    if (!may_be_replaced(role)) return PeerEvent::lost;
    peer.gone_ns = now_ns;
    return PeerEvent::gone;
  }
  if (silent_ns > kSilentAfter.ns && !peer.is_silent) {
    peer.is_silent = true;
    return PeerEvent::silent;
  }
  if (silent_ns <= kSilentAfter.ns && peer.is_silent) {
    peer.is_silent = false;
    return PeerEvent::back;
  }
  return PeerEvent::none;
}

PeerEvent SessionMember::watch_peers(std::int64_t now_ns, Role& about) {
  excuse_peers(now_ns);
  const bool looks_for_processes = now_ns - processes_ns_ >= kProcessLook.ns;
  if (looks_for_processes) processes_ns_ = now_ns;
  for (const Role role : transport::node_roles()) {
    if (role == role_ || !requires_role(role)) continue;
    Peer& peer = peers_[static_cast<std::size_t>(role)];
    if (!peer.is_known || peer.status.state >= NodeState::ended) continue;
    about = role;
    if (looks_for_processes && peer.exit_seen_ns == 0 && peer.process.has_exited()) peer.exit_seen_ns = now_ns;
    if (const PeerEvent event = look_at(peer, role, now_ns); event != PeerEvent::none) return event;
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
  const std::string stood_still =
      "stood still for " + seconds_text({stood_still_ns_}) + (stood_sending_ ? " while it sent" : "");
  // a process that was stopped may have been sending just then
  const std::string remedy =
      std::string("; look for what stopped the process (a signal, a debugger, lack of memory or of processors)") +
      (stood_sending_ ? " or took nothing from it (a cable that is out, an interface that is down)" : "");
  if (is_given_up && stood_still_ns_ > 0) {
    return "this node " + stood_still + " at step " + std::to_string(status_.header.step) + " and was given up after " +
           give_up_text() + "; session '" + session_.name + "' has ended" + remedy;
  }
  if (is_given_up) {
    return "this node ran, but its messages did not arrive for " + give_up_text() +
           " and it was given up; check the network from this machine to the others; " + reason;
  }
  // the peers may have given this node up and exited
  if (peer.is_lost && stood_still_ns_ > 0 && watched_ns_ - stood_until_ns_ <= session_.give_up_ns + linger().ns) {
    return reason + "; this node itself had " + stood_still + ", and after " + give_up_text() +
           " the others give a node up" + remedy;
  }
  return reason;
}

}  // namespace slew::node
