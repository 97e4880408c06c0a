// SPDX-License-Identifier: Apache-2.0
#include "node/session_member.h"

#include <algorithm>
#include <utility>

#include "transport/roles.h"
#include "transport/topics.h"

namespace slew::node {
namespace {

using wire::NodeState;
using wire::Phase;
using wire::Role;
using wire::Topic;

// Distinguishes processes of one role. Never 0.
std::uint32_t incarnation_of(const Identity& identity) {
  const std::uint64_t mixed = static_cast<std::uint64_t>(identity.started_ns) * 0x9e3779b97f4a7c15u + identity.pid;
  return static_cast<std::uint32_t>(mixed >> 32) | 1u;
}

}  // namespace

SessionMember::SessionMember(Role role, transport::Transport& transport, std::span<const Topic> step_topics,
                             std::optional<wire::SessionId> only)
    : role_(role),
      transport_(transport),
      step_topics_(step_topics.begin(), step_topics.end()),
      only_(only),
      identity_(this_process()),
      incarnation_(incarnation_of(identity_)) {
  status_.host = identity_.host;
  status_.pid = identity_.pid;
  status_.started_ns = identity_.started_ns;
  status_.build = identity_.build;
  status_.self_test = identity_.self_test;
}

SessionChange SessionMember::change_of(const wire::SessionDescription& session) const noexcept {
  const Phase phase = session.header.phase;
  if (has_session_) {
    const bool is_owner = is_in_session(session.header) && is_writer(session.header, Topic::session);
    if (!is_owner) return SessionChange::none;
    if (phase == Phase::ended) return SessionChange::withdrawn;
    const bool is_changed = session.given_up != session_.given_up || session.header.step != session_.header.step;
    return phase == Phase::running && is_changed ? SessionChange::renewed : SessionChange::none;
  }
  // in phase JOIN a description only claims the name
  const bool is_wanted = !only_ || session.header.session == *only_;
  return phase == Phase::running && is_wanted ? SessionChange::begins : SessionChange::none;
}

Status SessionMember::adopt(const wire::SessionDescription& session, std::int64_t now_ns) {
  session_ = session;
  has_session_ = true;
  epoch_ = session.header.epoch;
  // the description identifies its owner, so that the end of the owner is noticed even without a further message
  if (role_ != Role::io) {
    Peer& io = peers_[Role::io];
    io.is_known = true;
    io.incarnation = session.header.incarnation;
    io.last_received_ns = now_ns;
    io.status.header = session.header;
    io.status.state = NodeState::joining;
    io.status.host = session.host;
    io.status.pid = session.pid;
    io.status.started_ns = session.started_ns;
    if (session.host == identity_.host && session.pid != identity_.pid) io.process = ProcessWatch(session.pid);
  }
  Status refusal = Status::ok();
  for (const wire::NodeStatus& status : std::exchange(pending_statuses_, {})) {
    const Status taken = take_status(status, now_ns);
    if (refusal.is_ok()) refusal = taken;
  }
  return refusal;
}

void SessionMember::renew(const wire::SessionDescription& session, std::int64_t now_ns) {
  // no field that the thread of the health report reads
  session_.header.step = session.header.step;
  session_.header.epoch = session.header.epoch;
  session_.given_up = session.given_up;
  forget_given_up(now_ns);
  // new processes receive the present status
  status_changed_ = true;
}

Status SessionMember::problem_of_protocol() const {
  if (session_.protocol == wire::kProtocolVersion) return Status::ok();
  return Status::error(ExitCode::bad_input, "session '" + session_.name + "' speaks protocol version " +
                                                std::to_string(session_.protocol) + ", this program " +
                                                std::to_string(wire::kProtocolVersion) +
                                                "; use one version on all machines");
}

wire::Header SessionMember::header(wire::Phase phase, StepIndex step, std::uint32_t epoch) const noexcept {
  return {session_.header.session, role_, incarnation_, epoch, phase, step};
}

bool SessionMember::is_in_session(const wire::Header& header) const noexcept {
  return has_session_ && header.session == session_.header.session;
}

// The writer holds its role, and the role writes the topic.
bool SessionMember::is_writer(const wire::Header& header, Topic topic) const noexcept {
  if ((transport::writers_of(topic) & bit(header.role)) == 0) return false;
  const Peer& peer = peers_[header.role];
  return peer.is_known && peer.incarnation == header.incarnation;
}

bool SessionMember::is_of_session(const wire::Header& header, Topic topic) noexcept {
  if (!is_in_session(header)) {
    ++(has_session_ ? refusals_.other_session : refusals_.early);
    return false;
  }
  if (!is_writer(header, topic)) {
    const bool is_early = (transport::writers_of(topic) & bit(header.role)) != 0 && !peer(header.role).is_known;
    ++(is_early ? refusals_.early : refusals_.unexpected_writer);
    return false;
  }
  return true;
}

bool SessionMember::begins_next_epoch(const wire::Header& header) const noexcept {
  return header.phase == wire::Phase::init && header.epoch == epoch_ + 1 && is_in_session(header) &&
         is_writer(header, Topic::tick);
}

bool SessionMember::fits(const wire::Header& header, Topic topic) noexcept {
  if (!is_of_session(header, topic)) return false;
  if (header.epoch != epoch_) {
    ++refusals_.other_epoch;
    return false;
  }
  return true;
}

void SessionMember::set_state(NodeState state) noexcept {
  if (status_.state == state || status_.state == NodeState::fault) return;
  if (status_.state == NodeState::holding) reason_.clear();
  status_.state = state;
  status_changed_ = true;
}

void SessionMember::hold(std::string reason) {
  set_state(NodeState::holding);
  reason_ = std::move(reason);
  status_changed_ = true;
}

void SessionMember::fail(ExitCode code, std::string reason) {
  if (status_.state == NodeState::fault) return;
  status_.exit_code = static_cast<std::int32_t>(code);
  set_state(NodeState::fault);
  reason_ = std::move(reason);
}

void SessionMember::step_aside(ExitCode code, std::string reason) {
  fail(code, std::move(reason));
  is_aside_ = true;
}

void SessionMember::yield() {
  const Status why = given_to_another();
  step_aside(why.code, why.text);
}

void SessionMember::withdraw() {
  if (only_) return step_aside(ExitCode::bad_input, "io ended the session: another one holds its name");
  step_aside(ExitCode::ok, "");
  is_withdrawn_ = true;
}

void SessionMember::end(ExitCode code, std::string reason) {
  if (status_.state == NodeState::fault) return;
  status_.exit_code = static_cast<std::int32_t>(code);
  set_state(NodeState::ended);
  reason_ = std::move(reason);
}

void SessionMember::publish_status_if_changed() {
  if (!status_changed_ || !has_session_ || is_aside_) return;
  status_changed_ = false;
  status_.reason = reason_.substr(0, wire::kMaxReasonLength);
  const StepIndex step = status_.header.step;
  status_.header = header(wire::Phase::running, step);
  publish(Topic::node_status, status_);
}

std::vector<std::string> SessionMember::take_warnings() {
  return std::exchange(warnings_, {});
}

bool SessionMember::all_required(NodeState at_least) const noexcept {
  for (const Role role : transport::node_roles()) {
    if (role == role_ || !requires_role(role)) continue;
    const Peer& peer = peers_[role];
    // a peer that is gone or never joined counts as ended
    if (at_least == NodeState::ended && (peer.is_lost || !peer.is_known)) continue;
    if (!peer.is_known || peer.status.state < at_least) return false;
    // ready and running count only for the present epoch
    if (at_least < NodeState::ended && peer.status.header.epoch != epoch_) return false;
  }
  return true;
}

void SessionMember::acknowledge(const wire::Header& from, Topic topic, std::int64_t now_ns) {
  if (static_cast<std::size_t>(from.role) < wire::kRoles) peers_[from.role].last_received_ns = now_ns;
  const wire::Heard entry{from.role, from.incarnation, static_cast<std::uint8_t>(topic)};
  if (std::find(status_.heard.begin(), status_.heard.end(), entry) != status_.heard.end()) return;
  if (status_.heard.size() == wire::kMaxHeard) return;
  status_.heard.push_back(entry);
  status_changed_ = true;
}

bool SessionMember::must_read(Role reader, Topic topic) const noexcept {
  const bool is_of_flexible_bodies = topic == Topic::flexible || topic == Topic::elastic;
  if (is_of_flexible_bodies && !requires_role(Role::flex)) return false;
  if (topic == Topic::poses && !requires_role(Role::sensor)) return false;
  return reader != role_ && requires_role(reader) && (transport::readers_of(topic) & bit(reader)) != 0;
}

bool SessionMember::has_acknowledged(Role reader, Topic topic) const noexcept {
  const Peer& peer = peers_[reader];
  const wire::Heard me{role_, incarnation_, static_cast<std::uint8_t>(topic)};
  return peer.is_known && std::find(peer.status.heard.begin(), peer.status.heard.end(), me) != peer.status.heard.end();
}

bool SessionMember::is_acknowledged_on(Topic topic) const noexcept {
  return std::ranges::all_of(transport::node_roles(),
                             [&](Role reader) { return !must_read(reader, topic) || has_acknowledged(reader, topic); });
}

bool SessionMember::is_acknowledged_by_all() const noexcept {
  return std::all_of(step_topics_.begin(), step_topics_.end(), [&](Topic topic) { return is_acknowledged_on(topic); });
}

bool SessionMember::probe_is_due(std::int64_t now_ns) noexcept {
  if (now_ns < next_probe_ns_) return false;
  next_probe_ns_ = now_ns + kProbeInterval.ns;
  return true;
}

// The writers of a topic that the transport has discovered.
std::string SessionMember::found_writers(Topic topic) {
  const transport::TopicTraits& expected = transport::traits(topic);
  std::string text = std::string(" (expected topic ") + expected.name + ", type " + expected.type_name + "; found ";
  const std::vector<std::string> found = transport_.discovered_writers(topic);
  if (found.empty()) text += "no writer of it";
  for (const std::string& writer : found) text += (&writer == &found.front() ? "" : ", ") + writer;
  return text + ")";
}

std::string SessionMember::join_failure_text(SimDuration within) {
  std::string text;
  for (const Role role : transport::node_roles()) {
    if (role != role_ && requires_role(role) && !peer(role).is_known) {
      text += (text.empty() ? "" : "; ") + std::string("no ") + std::string(to_text(role)) +
              " node has joined session '" + session_.name + "'" + found_writers(transport::traits(role).sample);
    }
  }
  for (const Topic topic : step_topics_) {
    for (const Role reader : transport::node_roles()) {
      if (!peer(reader).is_known || !must_read(reader, topic) || has_acknowledged(reader, topic)) continue;
      text += (text.empty() ? "" : "; ") + describe_peer(reader) + " has not received topic '" +
              std::string(to_text(topic)) + "' from " + std::string(to_text(role_));
    }
  }
  return "JOIN did not come about within " + seconds_text(within) + ": " + text +
         "; start what is missing or find what holds it up; --join-timeout waits longer";
}

// Measures the time in which the network may have held this node up.
template <typename Publish>
void SessionMember::send_measured(const Publish& publish) noexcept {
  const bool may_wait = transport_.is_network();
  const std::int64_t begin_ns = may_wait ? monotonic_ns() : 0;
  Status status = publish();
  if (may_wait) peers_.add_sending({monotonic_ns() - begin_ns});
  if (!status.is_ok() && send_failure_.is_ok()) send_failure_ = std::move(status);
}

void SessionMember::send(Topic topic, std::span<const std::byte> bytes) noexcept {
  send_measured([&] { return transport_.publish(topic, bytes); });
}

void SessionMember::send(const transport::MessageObject& object, std::vector<std::byte>& buffer) noexcept {
  send_measured([&] { return transport_.publish_object(object, buffer); });
}

}  // namespace slew::node
