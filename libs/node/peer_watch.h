// SPDX-License-Identifier: Apache-2.0
// The other roles of a session, and the watch over the times of their messages.
//
// A peer is silent after kSilentAfter without a message: it is named, and the session holds. It is given up after the
// session's give_up_after, or kInFlight after its process on this machine has exited: lost, or gone where the session
// holds the place of a physics node for another process. Such a place is lost after the time to rejoin.
//
// A time between two looks longer than kUsualLook is silence of this process, not of its peers: it stood still, or the
// network held it up while it sent. A gap above kStoodStill is excused once, until the peer's next message; of a
// shorter one kUsualLook counts, at every look.
#pragma once

#include <array>
#include <cstdint>

#include "core/time.h"
#include "node/identity.h"
#include "transport/wire.h"

namespace slew::node {

inline constexpr SimDuration kSilentAfter = {300'000'000};
inline constexpr SimDuration kUsualLook = {100'000'000};
inline constexpr SimDuration kStoodStill = {1'000'000'000};  // the peers may have given this node up
inline constexpr SimDuration kInFlight = {20'000'000};       // last messages of a process that has exited
inline constexpr SimDuration kProcessLook = {1'000'000};     // between two checks that the processes exist

// State of another role of the session.
struct Peer {
  bool is_known = false;
  wire::NodeStatus status;
  std::uint32_t incarnation = 0;      // incarnation of the process that holds the role
  std::int64_t last_received_ns = 0;  // monotonic; less the time in which this process stood still
  std::int64_t excused_ns = -1;       // last_received_ns after that correction, until a message arrives
  ProcessWatch process;
  std::int64_t exit_seen_ns = 0;  // time at which the process was first seen to have exited; 0: it exists
  bool is_silent = false;         // named once
  bool is_lost = false;           // given up, or gone
  StepIndex step = kJoinStep;     // the next one to do, from its health
  std::uint32_t step_epoch = 0;   // epoch of that step
  std::int64_t gone_ns = 0;       // time at which it was seen to be gone; 0: it is not
};

// gone: a physics node whose place the session holds for another process of its role.
enum class PeerEvent : std::uint8_t { none, silent, back, gone, lost };

class PeerWatch {
 public:
  [[nodiscard]] Peer& operator[](wire::Role role) noexcept { return peers_[static_cast<std::size_t>(role)]; }
  [[nodiscard]] const Peer& operator[](wire::Role role) const noexcept {
    return peers_[static_cast<std::size_t>(role)];
  }

  // Excuses the peers from the time since the last look in which this process stood still. To be called before
  // look_at() of the peers.
  void begin_look(SimDuration give_up_after, std::int64_t now_ns) noexcept;
  // The change of a known peer that has not ended.
  PeerEvent look_at(wire::Role role, const wire::SessionDescription& session, std::int64_t now_ns) noexcept;
  // Time that this process has spent in sending.
  void add_sending(SimDuration time) noexcept { sending_ns_ += time.ns; }

  // The last gap between two looks in which the peers could give this process up; 0: there was none.
  [[nodiscard]] SimDuration stood_still() const noexcept { return {stood_still_ns_}; }
  // This process spent most of that gap in sending.
  [[nodiscard]] bool stood_sending() const noexcept { return stood_sending_; }
  // From its end to the last look.
  [[nodiscard]] SimDuration since_stood_still() const noexcept { return {watched_ns_ - stood_until_ns_}; }

 private:
  std::array<Peer, wire::kRoles> peers_;
  std::int64_t watched_ns_ = 0;       // time of the last look
  std::int64_t processes_ns_ = 0;     // time of the last check that the peers' processes exist
  bool looks_for_processes_ = false;  // in this look
  std::int64_t stood_still_ns_ = 0;
  std::int64_t stood_until_ns_ = 0;
  bool stood_sending_ = false;
  std::int64_t sending_ns_ = 0;      // time spent in sending since the last look
  std::int64_t sent_before_ns_ = 0;  // the same before that look
};

}  // namespace slew::node
