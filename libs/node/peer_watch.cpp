// SPDX-License-Identifier: Apache-2.0
#include "node/peer_watch.h"

#include <algorithm>
#include <utility>

#include "transport/roles.h"

namespace slew::node {

using wire::Role;

void PeerWatch::begin_look(SimDuration give_up_after, std::int64_t now_ns) noexcept {
  looks_for_processes_ = now_ns - processes_ns_ >= kProcessLook.ns;
  if (looks_for_processes_) processes_ns_ = now_ns;
  const std::int64_t gap_ns = watched_ns_ == 0 ? 0 : now_ns - watched_ns_;
  watched_ns_ = now_ns;
  // time spent in sending after the last check read the clock counts too
  const std::int64_t sending_ns = sending_ns_ + std::exchange(sent_before_ns_, sending_ns_);
  sending_ns_ = 0;
  if (gap_ns <= kUsualLook.ns) return;
  if (gap_ns > give_up_after.ns) {
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

PeerEvent PeerWatch::look_at(Role role, const wire::SessionDescription& session, std::int64_t now_ns) noexcept {
  Peer& peer = peers_[static_cast<std::size_t>(role)];
  if (looks_for_processes_ && peer.exit_seen_ns == 0 && peer.process.has_exited()) peer.exit_seen_ns = now_ns;
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
    if (now_ns - peer.gone_ns <= session.rejoin_ns + session.give_up_ns) return PeerEvent::none;
    peer.gone_ns = 0;
    return PeerEvent::lost;
  }
  if (peer.is_lost) return PeerEvent::none;
  if (is_gone || silent_ns > session.give_up_ns) {
    peer.is_lost = true;
    if (!transport::is_physics(role) || session.rejoin_ns <= 0) return PeerEvent::lost;
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

}  // namespace slew::node
