// SPDX-License-Identifier: Apache-2.0
#include "node/session_member.h"

#include <algorithm>
#include <utility>

#include "transport/roles.h"
#include "transport/session_state.h"
#include "transport/topics.h"

namespace slew::node {
namespace {

using wire::NodeState;
using wire::Phase;
using wire::Role;
using wire::Topic;

bool is_over(NodeState state) {
  return state == NodeState::ended || state == NodeState::fault;
}

// Distinguishes processes of one role. Never 0.
std::uint32_t incarnation_of(const Identity& identity) {
  const std::uint64_t mixed = static_cast<std::uint64_t>(identity.started_ns) * 0x9e3779b97f4a7c15u + identity.pid;
  return static_cast<std::uint32_t>(mixed >> 32) | 1u;
}

constexpr std::size_t kMaxPendingStatuses = 64;

bool is_ready_state(NodeState state) {
  return state >= NodeState::ready && state < NodeState::ended;
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
    Peer& io = peers_[static_cast<std::size_t>(Role::io)];
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

void SessionMember::forget_given_up(std::int64_t now_ns) {
  for (const wire::GivenUp& gone : session_.given_up) {
    const auto index = static_cast<std::size_t>(gone.role);
    if (index >= wire::kRoles || !peers_[index].is_known || peers_[index].incarnation != gone.incarnation) continue;
    peers_[index] = Peer{};
    if (const auto claimant = std::exchange(claimants_[index], std::nullopt)) {
      static_cast<void>(take_status(*claimant, now_ns));
    }
  }
}

bool SessionMember::is_given_up(Role role, std::uint32_t incarnation) const noexcept {
  return transport::is_given_up(session_, role, incarnation);
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
  const Peer& peer = peers_[static_cast<std::size_t>(header.role)];
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

Status SessionMember::given_to_another() const {
  return Status::error(ExitCode::node_lost, "the role " + std::string(to_text(role_)) + " of session '" +
                                                session_.name +
                                                "' was given to another process, because no message from this one "
                                                "arrived; this one ends, and the session goes on without it");
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

Status SessionMember::on_node_status(std::span<const std::byte> bytes, std::int64_t now_ns) {
  if (!transport::decode(bytes, received_status_)) {
    ++refusals_.undecodable;
    return Status::ok();
  }
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
  Peer& peer = peers_[index];
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
    const std::optional<std::uint32_t> chosen = holder(static_cast<Role>(index));
    Peer& peer = peers_[index];
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

std::vector<std::string> SessionMember::take_warnings() {
  return std::exchange(warnings_, {});
}

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
  return is_physics(role) && session_.rejoin_ns > 0;
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
  for (const Role role : wire::kNodeRoles) {
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
  for (const Role role : wire::kNodeRoles) {
    const Peer& peer = this->peer(role);
    if (requires_role(role) && peer.is_silent && !peer.is_lost && !is_over(peer.status.state)) return role;
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

bool SessionMember::all_required(NodeState at_least) const noexcept {
  for (const Role role : wire::kNodeRoles) {
    if (role == role_ || !requires_role(role)) continue;
    const Peer& peer = peers_[static_cast<std::size_t>(role)];
    // a peer that is gone or never joined counts as ended
    if (at_least == NodeState::ended && (peer.is_lost || !peer.is_known)) continue;
    if (!peer.is_known || peer.status.state < at_least) return false;
    // ready and running count only for the present epoch
    if (at_least < NodeState::ended && peer.status.header.epoch != epoch_) return false;
  }
  return true;
}

void SessionMember::acknowledge(const wire::Header& from, Topic topic, std::int64_t now_ns) {
  const auto index = static_cast<std::size_t>(from.role);
  if (index < wire::kRoles) peers_[index].last_received_ns = now_ns;
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
  const Peer& peer = peers_[static_cast<std::size_t>(reader)];
  const wire::Heard me{role_, incarnation_, static_cast<std::uint8_t>(topic)};
  return peer.is_known && std::find(peer.status.heard.begin(), peer.status.heard.end(), me) != peer.status.heard.end();
}

bool SessionMember::is_acknowledged_on(Topic topic) const noexcept {
  return std::all_of(std::begin(wire::kNodeRoles), std::end(wire::kNodeRoles),
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
  for (const Role role : wire::kNodeRoles) {
    if (role != role_ && requires_role(role) && !peer(role).is_known) {
      text += (text.empty() ? "" : "; ") + std::string("no ") + std::string(to_text(role)) +
              " node has joined session '" + session_.name + "'" + found_writers(transport::traits(role).sample);
    }
  }
  for (const Topic topic : step_topics_) {
    for (const Role reader : wire::kNodeRoles) {
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
  if (may_wait) sending_ns_ += monotonic_ns() - begin_ns;
  if (!status.is_ok() && send_failure_.is_ok()) send_failure_ = std::move(status);
}

void SessionMember::send(Topic topic, std::span<const std::byte> bytes) noexcept {
  send_measured([&] { return transport_.publish(topic, bytes); });
}

void SessionMember::send(const transport::MessageObject& object, std::vector<std::byte>& buffer) noexcept {
  send_measured([&] { return transport_.publish_object(object, buffer); });
}

}  // namespace slew::node
