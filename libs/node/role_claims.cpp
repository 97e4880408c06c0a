// SPDX-License-Identifier: Apache-2.0
// Which process holds a role: the one that io has chosen. Other claimants are ignored, or refused.
#include <algorithm>
#include <utility>

#include "node/session_member.h"
#include "transport/session_state.h"

namespace slew::node {
namespace {

using wire::NodeState;
using wire::Role;
using wire::Topic;

bool is_over(NodeState state) {
  return state == NodeState::ended || state == NodeState::fault;
}

constexpr std::size_t kMaxPendingStatuses = 64;

bool is_ready_state(NodeState state) {
  return state >= NodeState::ready && state < NodeState::ended;
}

}  // namespace

void SessionMember::forget_given_up(std::int64_t now_ns) {
  for (const wire::GivenUp& gone : session_.given_up) {
    const auto index = static_cast<std::size_t>(gone.role);
    if (index >= wire::kRoles || !peers_[gone.role].is_known || peers_[gone.role].incarnation != gone.incarnation) {
      continue;
    }
    peers_[gone.role] = Peer{};
    if (const auto claimant = std::exchange(claimants_[index], std::nullopt)) {
      static_cast<void>(take_status(*claimant, now_ns));
    }
  }
}

bool SessionMember::is_given_up(Role role, std::uint32_t incarnation) const noexcept {
  return transport::is_given_up(session_, role, incarnation);
}

Status SessionMember::given_to_another() const {
  return Status::error(ExitCode::node_lost, "the role " + std::string(to_text(role_)) + " of session '" +
                                                session_.name +
                                                "' was given to another process, because no message from this one "
                                                "arrived; this one ends, and the session goes on without it");
}

Status SessionMember::on_node_status(std::span<const std::byte> bytes, std::int64_t now_ns) {
  if (!decode(bytes, received_status_)) return Status::ok();
  if (!has_session_) {
    if (pending_statuses_.size() < kMaxPendingStatuses) pending_statuses_.push_back(received_status_);
    return Status::ok();
  }
  return take_status(received_status_, now_ns);
}

Status SessionMember::take_status(const wire::NodeStatus& status, std::int64_t now_ns) {
  if (status.header.session != session_.header.session) {
    ++refusals_.other_session;
    return Status::ok();
  }
  const Role role = status.header.role;
  const auto index = static_cast<std::size_t>(role);
  if (index >= wire::kRoles) return Status::ok();
  if (role == role_) return on_own_role(status);
  Peer& peer = peers_[role];
  if (is_given_up(role, status.header.incarnation)) {
    ++refusals_.unexpected_writer;
    return Status::ok();
  }
  if (!may_hold(status, peer)) {
    if (role != Role::io) claimants_[index] = status;
    ++refusals_.unexpected_writer;
    return Status::ok();
  }
  if (peer.is_known && peer.incarnation != status.header.incarnation) peer = Peer{};
  if (!peer.is_known) {
    if (status.host == identity_.host && status.pid != identity_.pid) peer.process = ProcessWatch(status.pid);
    compare_builds(status);
  }
  peer.is_known = true;
  peer.incarnation = status.header.incarnation;
  peer.status = status;
  peer.last_received_ns = now_ns;
  if (role_ == Role::io) acknowledge(status.header, Topic::node_status, now_ns);
  return role == Role::io ? follow_choice(now_ns) : Status::ok();
}

// The process of the role that io has chosen.
std::optional<std::uint32_t> SessionMember::holder(Role role) const noexcept {
  const std::vector<wire::Heard>& choices = role_ == Role::io ? status_.heard : peer(Role::io).status.heard;
  const auto chosen = std::find_if(choices.rbegin(), choices.rend(), [&](const wire::Heard& entry) {
    return entry.role == role && entry.topic == static_cast<std::uint8_t>(Topic::node_status) &&
           !is_given_up(role, entry.incarnation);
  });
  return chosen == choices.rend() ? std::nullopt : std::optional(chosen->incarnation);
}

// The writer of this status has the role, as far as this node has received: the session's owner, the process that io
// has chosen, or before its choice the first process received that has not ended.
bool SessionMember::may_hold(const wire::NodeStatus& status, const Peer& peer) const noexcept {
  const std::uint32_t claimant = status.header.incarnation;
  if (status.header.role == Role::io) return claimant == session_.header.incarnation;
  if (peer.is_known && peer.incarnation == claimant) return true;
  if (peer.is_known && peer.is_lost) return false;
  const bool is_vacant = !peer.is_known || (is_over(peer.status.state) && !is_over(status.state));
  if (role_ == Role::io) return is_vacant;
  const std::optional<std::uint32_t> chosen = holder(status.header.role);
  return chosen ? *chosen == claimant : is_vacant;
}

// io has published its choice: peers that it has not chosen are dropped.
Status SessionMember::follow_choice(std::int64_t now_ns) {
  for (std::size_t index = 0; index < wire::kRoles; ++index) {
    const auto role = static_cast<Role>(index);
    const std::optional<std::uint32_t> chosen = holder(role);
    Peer& peer = peers_[role];
    if (!chosen || !peer.is_known || peer.is_lost || peer.incarnation == *chosen) continue;
    peer = Peer{};
    if (const auto claimant = std::exchange(claimants_[index], std::nullopt))
      static_cast<void>(take_status(*claimant, now_ns));
  }
  was_chosen_ = was_chosen_ || holds_role();
  const auto claimant = claimants_[static_cast<std::size_t>(role_)];
  return claimant && !holds_role() ? on_own_role(*claimant) : Status::ok();
}

void SessionMember::warn_of_claim(const wire::NodeStatus& status) {
  // a process that was just started receives from io that the role is held; a later process may have been given it
  const bool is_usual = !is_ready_state(status.state) || status.started_ns > identity_.started_ns;
  if (is_usual || std::exchange(has_warned_of_claim_, true)) return;
  warn("process " + std::to_string(status.pid) + " on " + machine_of(status.host) + ", started " +
       time_text(status.started_ns) + ", claims the role " + std::string(to_text(role_)) + " of session '" +
       session_.name + "'; this process keeps the role and ignores the other one; stop the other process");
}

// Another process claims the role of this one.
Status SessionMember::on_own_role(const wire::NodeStatus& status) {
  if (status.header.incarnation == incarnation_ || is_over(status.state)) return Status::ok();
  if (is_given_up(role_, status.header.incarnation)) return Status::ok();
  claimants_[static_cast<std::size_t>(role_)] = status;
  const std::optional<std::uint32_t> chosen = role_ == Role::io ? incarnation_ : holder(role_);
  if (chosen == incarnation_) {
    ++refusals_.unexpected_writer;
    warn_of_claim(status);
  }
  if (!chosen || *chosen != status.header.incarnation) return Status::ok();
  // io's update that this process was given up may arrive after its new choice
  if (was_chosen_) return given_to_another();
  return Status::error(ExitCode::bad_input,
                       "the role " + std::string(to_text(role_)) + " of session '" + session_.name +
                           "' is held by process " + std::to_string(status.pid) + " on " + machine_of(status.host) +
                           ", started " + time_text(status.started_ns) +
                           "; this second one ends; stop the first, or choose another --session name");
}

void SessionMember::compare_builds(const wire::NodeStatus& status) {
  // only the owner compares, so that each difference is reported once
  if (role_ != Role::io) return;
  const std::string peer = std::string(to_text(status.header.role)) + " on " + machine_of(status.host);
  if (status.self_test != identity_.self_test) {
    warnings_.push_back(
        peer + " computes the arithmetic self-test with another result than io: this session's bits " +
        "cannot be compared with those of another layout; use processors of one family and one C library");
  } else if (status.build != identity_.build) {
    warnings_.push_back(peer + " is of build '" + status.build + "', io of '" + identity_.build +
                        "': bits may differ from those of one build; install one build on all machines");
  }
}

}  // namespace slew::node
