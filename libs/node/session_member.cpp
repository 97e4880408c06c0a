#include "node/session_member.h"

#include <algorithm>
#include <utility>

namespace slew::node {
namespace {

using wire::NodeState;
using wire::Role;
using wire::Topic;

constexpr Role kAllRoles[] = {Role::io, Role::mechanics, Role::hydraulics, Role::flex, Role::recorder};

bool is_same_process(const wire::NodeStatus& a, const Identity& b) {
  return a.host == b.host && a.pid == b.pid && a.started_ns == b.started_ns;
}

// of two claimants of a role: the one that is further on, else the one that started first, else the lower pid
bool other_goes_first(const wire::NodeStatus& other, NodeState own_state, const Identity& own) {
  const bool other_runs = other.state >= NodeState::ready && other.state <= NodeState::holding;
  const bool own_runs = own_state >= NodeState::ready && own_state <= NodeState::holding;
  if (other_runs != own_runs) return other_runs;
  if (other.started_ns != own.started_ns) return other.started_ns < own.started_ns;
  return std::pair(other.pid, other.host) < std::pair(own.pid, own.host);
}

}  // namespace

std::uint32_t readers_of(Topic topic) noexcept {
  switch (topic) {
    case Topic::tick: return bit(Role::mechanics) | bit(Role::hydraulics) | bit(Role::flex) | bit(Role::recorder);
    case Topic::mechanism: return bit(Role::io) | bit(Role::hydraulics) | bit(Role::flex) | bit(Role::recorder);
    case Topic::actuators: return bit(Role::io) | bit(Role::mechanics) | bit(Role::recorder);
    case Topic::variables: return bit(Role::recorder);
    default: return 0;
  }
}

SessionMember::SessionMember(Role role, transport::Transport& transport, std::span<const Topic> step_topics)
    : role_(role),
      transport_(transport),
      step_topics_(step_topics.begin(), step_topics.end()),
      identity_(this_process()) {
  status_.host = identity_.host;
  status_.pid = identity_.pid;
  status_.started_ns = identity_.started_ns;
  status_.build = identity_.build;
  status_.self_test = identity_.self_test;
}

void SessionMember::adopt(const wire::SessionDescription& session) {
  session_ = session;
  has_session_ = true;
  epoch_ = session.header.epoch;
}

wire::Header SessionMember::header(wire::Phase phase, StepIndex step) const noexcept {
  return {session_.header.session, role_, 1, epoch_, phase, step};
}

bool SessionMember::fits(const wire::Header& header) noexcept {
  if (!has_session_ || header.session != session_.header.session) {
    ++refusals_.other_session;
    return false;
  }
  if (header.epoch != epoch_) {
    ++refusals_.other_epoch;
    return false;
  }
  return true;
}

void SessionMember::set_state(NodeState state) noexcept {
  if (status_.state == state) return;
  status_.state = state;
  status_changed_ = true;
}

void SessionMember::fail(ExitCode code, std::string reason) {
  if (status_.state == NodeState::fault) return;
  status_.exit_code = static_cast<std::int32_t>(code);
  reason.resize(std::min(reason.size(), wire::kMaxReasonLength));
  status_.reason = std::move(reason);
  set_state(NodeState::fault);
}

void SessionMember::end(ExitCode code) {
  if (status_.state == NodeState::fault) return;
  status_.exit_code = static_cast<std::int32_t>(code);
  set_state(NodeState::ended);
}

void SessionMember::publish_status_if_changed() {
  if (!status_changed_ || !has_session_) return;
  status_changed_ = false;
  const StepIndex step = status_.header.step;
  status_.header = header(wire::Phase::running, step);
  publish(Topic::node_status, status_);
}

Status SessionMember::on_node_status(std::span<const std::byte> bytes, std::int64_t now_ns) {
  wire::NodeStatus status;
  if (!transport::decode(bytes, status)) {
    ++refusals_.undecodable;
    return Status::ok();
  }
  if (!has_session_ || status.header.session != session_.header.session) {
    ++refusals_.other_session;
    return Status::ok();
  }
  const auto index = static_cast<std::size_t>(status.header.role);
  if (index >= wire::kRoles) return Status::ok();
  if (status.header.role == role_) {
    const bool is_over = status.state == NodeState::ended || status.state == NodeState::fault;
    if (is_same_process(status, identity_) || is_over || !other_goes_first(status, status_.state, identity_)) {
      return Status::ok();
    }
    return Status::error(ExitCode::bad_input,
                         "the role " + std::string(to_text(role_)) + " of session '" + session_.name +
                             "' is held by process " + std::to_string(status.pid) + " on " +
                             status.host.substr(0, status.host.find('#')) + ", started " +
                             time_text(status.started_ns) +
                             "; this second one ends; stop the first, or choose another --session name");
  }
  Peer& peer = peers_[index];
  if (!peer.is_known || peer.status.pid != status.pid) {
    if (status.host == identity_.host && status.pid != identity_.pid) peer.process = ProcessWatch(status.pid);
  }
  peer.is_known = true;
  peer.status = std::move(status);
  peer.last_heard_ns = now_ns;
  return Status::ok();
}

void SessionMember::on_health(std::span<const std::byte> bytes, std::int64_t now_ns) {
  wire::Health health;
  if (!transport::decode(bytes, health) || !has_session_ || health.header.session != session_.header.session) return;
  const auto index = static_cast<std::size_t>(health.header.role);
  if (index < wire::kRoles) peers_[index].last_heard_ns = now_ns;
}

PeerEvent SessionMember::watch_peers(std::int64_t now_ns, Role& about) {
  for (const Role role : kAllRoles) {
    if (role == role_ || !requires_role(role)) continue;
    Peer& peer = peers_[static_cast<std::size_t>(role)];
    if (!peer.is_known || peer.is_lost || peer.status.state >= NodeState::ended) continue;
    about = role;
    const std::int64_t silent_ns = now_ns - peer.last_heard_ns;
    if (peer.process.has_exited() || silent_ns > kLostAfter.ns) {
      peer.is_lost = true;
      return PeerEvent::lost;
    }
    if (silent_ns > kSilentAfter.ns && !peer.is_silent) {
      peer.is_silent = true;
      return PeerEvent::silent;
    }
    if (silent_ns <= kSilentAfter.ns && peer.is_silent) {
      peer.is_silent = false;
      return PeerEvent::back;
    }
  }
  return PeerEvent::none;
}

std::string SessionMember::describe_peer(Role role) const {
  const Peer& peer = this->peer(role);
  std::string text(to_text(role));
  if (!peer.is_known) return text;
  return text + " (process " + std::to_string(peer.status.pid) + " on " +
         peer.status.host.substr(0, peer.status.host.find('#')) + ")";
}

bool SessionMember::all_required(NodeState at_least) const noexcept {
  for (const Role role : kAllRoles) {
    if (role == role_ || !requires_role(role)) continue;
    const Peer& peer = peers_[static_cast<std::size_t>(role)];
    if (peer.is_lost && at_least == NodeState::ended) continue;
    if (!peer.is_known || peer.status.state < at_least) return false;
    // ready and running count only for the present epoch
    if (at_least < NodeState::ended && peer.status.header.epoch != epoch_) return false;
  }
  return true;
}

void SessionMember::heard(const wire::Header& from, Topic topic, std::int64_t now_ns) {
  const auto index = static_cast<std::size_t>(from.role);
  if (index < wire::kRoles) peers_[index].last_heard_ns = now_ns;
  const wire::Heard entry{from.role, from.incarnation, static_cast<std::uint8_t>(topic)};
  if (std::find(status_.heard.begin(), status_.heard.end(), entry) != status_.heard.end()) return;
  status_.heard.push_back(entry);
  status_changed_ = true;
}

bool SessionMember::must_read(Role reader, Topic topic) const noexcept {
  return reader != role_ && requires_role(reader) && (readers_of(topic) & bit(reader)) != 0;
}

bool SessionMember::has_heard_me(Role reader, Topic topic) const noexcept {
  const Peer& peer = peers_[static_cast<std::size_t>(reader)];
  const wire::Heard me{role_, 1, static_cast<std::uint8_t>(topic)};
  return peer.is_known &&
         std::find(peer.status.heard.begin(), peer.status.heard.end(), me) != peer.status.heard.end();
}

bool SessionMember::is_heard_on(Topic topic) const noexcept {
  return std::all_of(std::begin(kAllRoles), std::end(kAllRoles),
                     [&](Role reader) { return !must_read(reader, topic) || has_heard_me(reader, topic); });
}

bool SessionMember::is_heard_by_all() const noexcept {
  return std::all_of(step_topics_.begin(), step_topics_.end(), [&](Topic topic) { return is_heard_on(topic); });
}

bool SessionMember::probe_is_due(std::int64_t now_ns) noexcept {
  if (now_ns < next_probe_ns_) return false;
  next_probe_ns_ = now_ns + kProbeInterval.ns;
  return true;
}

std::string SessionMember::missing_join_text() {
  std::string text;
  for (const Role role : kAllRoles) {
    if (role != role_ && requires_role(role) && !peer(role).is_known) {
      text += (text.empty() ? "" : "; ") + std::string("no ") + std::string(to_text(role)) +
              " node has been heard in session '" + session_.name + "'";
    }
  }
  for (const Topic topic : step_topics_) {
    for (const Role reader : kAllRoles) {
      if (!peer(reader).is_known || !must_read(reader, topic) || has_heard_me(reader, topic)) continue;
      text += (text.empty() ? "" : "; ") + describe_peer(reader) + " has not heard topic '" +
              std::string(to_text(topic)) + "' of " + std::string(to_text(role_));
      for (const std::string& writer : transport_.discovered_writers(topic)) text += ", found " + writer;
    }
  }
  return text;
}

void SessionMember::send(Topic topic, std::span<const std::byte> bytes) noexcept {
  const Status status = transport_.publish(topic, bytes);
  if (!status.is_ok() && status_.state != NodeState::fault) {
    status_.exit_code = static_cast<std::int32_t>(status.code);
    status_.reason = status.text.substr(0, wire::kMaxReasonLength);
    set_state(NodeState::fault);
  }
}

}  // namespace slew::node
