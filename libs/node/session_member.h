// SPDX-License-Identifier: Apache-2.0
// The common part of all nodes: the identity of the node, the state of its peers, the start-up check (JOIN) and the
// detection of lost peers.
//
// JOIN: a writer repeats step -1 on each of its step topics until every required reader has acknowledged it in its
// NodeStatus. "Matched" at the transport proves nothing; only a received message does.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/check.h"
#include "core/status.h"
#include "node/identity.h"
#include "node/peer_watch.h"
#include "node/sent_cache.h"
#include "transport/cdr/codec.h"
#include "transport/message_object.h"
#include "transport/transport.h"
#include "transport/wire.h"

namespace slew::node {

inline constexpr SimDuration kJoinTimeout = {10'000'000'000};
// for nodes that run in turns in one thread: none of them can be missing, and the machine may be slow
inline constexpr SimDuration kNoTimeout = {100LL * 365 * 86400 * 1'000'000'000};
inline constexpr SimDuration kProbeInterval = {20'000'000};
inline constexpr SimDuration kResendAfter = {3'000'000};     // then a missing step is requested
inline constexpr SimDuration kResendAtMost = {100'000'000};  // longest pause between two requests
inline constexpr SimDuration kHealthInterval = {100'000'000};
inline constexpr SimDuration kLinger = {2'000'000'000};  // least time for which a node resends after its own end

// Messages that were received but not applied, by cause.
struct Refusals {
  // faults: a damaged message, a foreign session, two processes of one role, a writer that runs ahead
  std::uint64_t undecodable = 0;
  std::uint64_t other_session = 0;
  std::uint64_t unexpected_writer = 0;
  std::uint64_t too_far_ahead = 0;
  // part of every healthy session
  std::uint64_t early = 0;        // before this node had the session or the writer, or sensors were near: repeated
  std::uint64_t other_epoch = 0;  // in flight while the session was reset
  std::uint64_t duplicate = 0;    // the step is present or done: a message that was resent twice
  [[nodiscard]] std::uint64_t refused() const noexcept {
    return undecodable + other_session + unexpected_writer + too_far_ahead;
  }
};

// Effect of a received session description on a node that does not own the session.
enum class SessionChange : std::uint8_t {
  none,
  begins,     // the session to take part in
  renewed,    // the owner has updated the processes given up or the step of the session
  withdrawn,  // the owner withdraws the session: another one holds the name
};

// How a node finds its session.
struct JoinOptions {
  SimDuration session_timeout = milliseconds(30'000);  // longest wait for a session of the name
  SimDuration join_timeout = kJoinTimeout;             // longest wait for the other nodes of the session
  std::optional<wire::SessionId> session;              // the only one to take part in; none: the first of the name
};

class SessionMember {
 public:
  // step_topics: the topics this role writes step by step, which JOIN must prove.
  // only: the one session this node may take part in; none: any of its name.
  SessionMember(wire::Role role, transport::Transport& transport, std::span<const wire::Topic> step_topics,
                std::optional<wire::SessionId> only = std::nullopt);

  [[nodiscard]] wire::Role role() const noexcept { return role_; }
  [[nodiscard]] const Identity& identity() const noexcept { return identity_; }
  [[nodiscard]] transport::Transport& transport() noexcept { return transport_; }

  // ---- session
  [[nodiscard]] SessionChange change_of(const wire::SessionDescription& session) const noexcept;
  // Takes part in a session. Takes the NodeStatus messages that arrived before; returns a refusal when another process
  // holds this role.
  Status adopt(const wire::SessionDescription& session, std::int64_t now_ns);
  // Takes an updated description. Places of processes that were given up are free for other processes.
  void renew(const wire::SessionDescription& session, std::int64_t now_ns);
  // The session has given this process up: another one may have its role.
  [[nodiscard]] bool is_given_up() const noexcept { return is_given_up(role_, incarnation_); }
  // The session has begun, or begins, at a step whose state io has.
  [[nodiscard]] bool has_state() const noexcept { return session_.header.step >= 0; }
  // Ok when the session has this program's protocol version.
  [[nodiscard]] Status problem_of_protocol() const;
  [[nodiscard]] bool has_session() const noexcept { return has_session_; }
  [[nodiscard]] const wire::SessionDescription& session() const noexcept { return session_; }
  // Silence after which the session gives a node up (session.give_up_after), and the same with its key for a message:
  // "2 s (session.give_up_after)".
  [[nodiscard]] SimDuration give_up_after() const noexcept { return {session_.give_up_ns}; }
  [[nodiscard]] std::string give_up_text() const;
  // Longest time for which this node answers resend requests after its own end: a peer may resume after a silence.
  [[nodiscard]] SimDuration linger() const noexcept { return {std::max(kLinger.ns, session_.give_up_ns)}; }
  [[nodiscard]] bool requires_role(wire::Role role) const noexcept {
    return (session_.required_roles & bit(role)) != 0;
  }
  [[nodiscard]] std::uint32_t epoch() const noexcept { return epoch_; }
  void set_epoch(std::uint32_t epoch) noexcept { epoch_ = epoch; }
  [[nodiscard]] wire::Header header(wire::Phase phase, StepIndex step) const noexcept {
    return header(phase, step, epoch_);
  }
  [[nodiscard]] wire::Header header(wire::Phase phase, StepIndex step, std::uint32_t epoch) const noexcept;

  // True when a message on this topic belongs to this session and its writer holds a role which writes the topic;
  // counts it otherwise.
  [[nodiscard]] bool is_of_session(const wire::Header& header, wire::Topic topic) noexcept;
  // The same, and the message belongs to the present epoch.
  [[nodiscard]] bool fits(const wire::Header& header, wire::Topic topic) noexcept;
  // True for the INIT tick with which io begins the next epoch.
  [[nodiscard]] bool begins_next_epoch(const wire::Header& header) const noexcept;
  [[nodiscard]] Refusals& refusals() noexcept { return refusals_; }

  // ---- bytes
  // transport::decode() and its relations; counts what cannot be decoded.
  template <typename M>
  [[nodiscard]] bool decode(transport::Bytes bytes, M& message) {
    return is_decoded(transport::decode(bytes, message));
  }
  [[nodiscard]] bool decode_header(transport::Bytes bytes, wire::Header& header) {
    return is_decoded(transport::decode_header(bytes, header));
  }
  [[nodiscard]] bool header_of(const transport::Received& message, wire::Header& header) {
    return is_decoded(transport::header_of(message, header));
  }

  // ---- state and status
  void set_state(wire::NodeState state) noexcept;
  [[nodiscard]] wire::NodeState state() const noexcept { return status_.state; }
  void set_step(StepIndex step) noexcept { status_.header.step = step; }
  void set_recorded_step(StepIndex step) noexcept { status_.recorded_step = step; }
  void fail(ExitCode code, std::string reason);
  // reason: the origin of the request to end, when that is not this process's owner.
  void end(ExitCode code, std::string reason = "");
  // Ends without publishing it: this process never held the role.
  void step_aside(ExitCode code, std::string reason);
  // Steps aside because its role was given to another process.
  void yield();
  // Steps aside because the session was withdrawn: is_withdrawn(), or failed when it was bound to that session.
  void withdraw();
  // This process may take part in the next session of the name, as a new node on a new transport.
  [[nodiscard]] bool is_withdrawn() const noexcept { return is_withdrawn_; }
  // Holds for another node, which the reason in its status names; ends with the next set_state().
  void hold(std::string reason);
  [[nodiscard]] ExitCode exit_code() const noexcept { return static_cast<ExitCode>(status_.exit_code); }
  [[nodiscard]] const std::string& reason() const noexcept { return reason_; }
  void mark_status_changed() noexcept { status_changed_ = true; }
  void publish_status_if_changed();

  // ---- peers
  // Takes a NodeStatus or Health message. Returns a refusal when another process holds this role. If several processes
  // claim one role, the one whose status io took first holds it. io publishes its choice in its own status: the last
  // entry of a role with topic node_status in the list of received writers, less those that were given up. Messages
  // from later claimants are ignored. No node becomes READY before io has chosen it, so that no later status takes its
  // role.
  Status on_node_status(std::span<const std::byte> bytes, std::int64_t now_ns);
  void on_health(std::span<const std::byte> bytes, std::int64_t now_ns);
  // io has chosen this process for its role.
  [[nodiscard]] bool holds_role() const noexcept { return holder(role_) == incarnation_; }
  [[nodiscard]] const Peer& peer(wire::Role role) const noexcept { return peers_[role]; }
  // Looks for silent and lost required peers (peer_watch.h); at most one event per call, with its role.
  PeerEvent watch_peers(std::int64_t now_ns, wire::Role& about);
  // Reason for the end of this node after a peer is gone or has ended: `reason`, and the part of this process in it
  // when it stood still itself or its messages did not arrive.
  [[nodiscard]] std::string end_text(wire::Role about, const std::string& reason) const;
  // A required role that has been named silent and has not come back.
  [[nodiscard]] std::optional<wire::Role> silent_peer() const noexcept;
  [[nodiscard]] std::string describe_peer(wire::Role role) const;
  // The named role has been silent for 0.3 s, for NodeStatus and logs.
  [[nodiscard]] std::string silence_text(wire::Role role) const;
  // Warnings for the user while the session goes on: those of warn(), and differences between the builds of this
  // program and a peer that may change the last bit of a result. Each once.
  void warn(std::string text) { warnings_.push_back(std::move(text)); }
  [[nodiscard]] std::vector<std::string> take_warnings();
  [[nodiscard]] bool all_required(wire::NodeState at_least) const noexcept;

  // ---- join
  // The header of a sample that fits(), which is then acknowledged.
  [[nodiscard]] bool receive_header(const transport::Received& message, wire::Header& header, std::int64_t now_ns) {
    if (!header_of(message, header) || !fits(header, message.topic)) return false;
    acknowledge(header, message.topic, now_ns);
    return true;
  }
  // Takes a message as received: it proves that its writer is alive and, in this node's status, that it arrives here.
  void acknowledge(const wire::Header& from, wire::Topic topic, std::int64_t now_ns);
  [[nodiscard]] bool is_acknowledged_by_all() const noexcept;
  [[nodiscard]] bool is_acknowledged_on(wire::Topic topic) const noexcept;
  [[nodiscard]] bool probe_is_due(std::int64_t now_ns) noexcept;
  // Why JOIN did not come about within a time, and what to do.
  [[nodiscard]] std::string join_failure_text(SimDuration within);

  // ---- sending
  // Pre-condition: texts and lists of the message are within their caps.
  template <typename Message>
  void publish(wire::Topic topic, const Message& message) {
    const bool is_encoded = transport::encode(message, buffer_);
    SLEW_CHECK(is_encoded);
    send(topic, buffer_);
  }
  void send(wire::Topic topic, std::span<const std::byte> bytes) noexcept;
  // Publishes a message as an object. The buffer holds its bytes then, or nothing when no reader needs them.
  template <typename Message>
  void publish_object(std::shared_ptr<const Message> message, std::vector<std::byte>& buffer) {
    send(transport::object_of(std::move(message)), buffer);
  }
  // The error of the first message that could not be sent; ok: all were sent. The node ends the session for it.
  [[nodiscard]] const Status& send_failure() const noexcept { return send_failure_; }

 private:
  void send(const transport::MessageObject& object, std::vector<std::byte>& buffer) noexcept;
  template <typename Publish>
  void send_measured(const Publish& publish) noexcept;
  [[nodiscard]] Status take_status(const wire::NodeStatus& status, std::int64_t now_ns);
  [[nodiscard]] bool is_given_up(wire::Role role, std::uint32_t incarnation) const noexcept;
  void forget_given_up(std::int64_t now_ns);
  [[nodiscard]] bool is_in_session(const wire::Header& header) const noexcept;
  [[nodiscard]] bool is_writer(const wire::Header& header, wire::Topic topic) const noexcept;
  [[nodiscard]] std::string found_writers(wire::Topic topic);
  [[nodiscard]] std::optional<std::uint32_t> holder(wire::Role role) const noexcept;
  [[nodiscard]] bool may_hold(const wire::NodeStatus& status, const Peer& peer) const noexcept;
  [[nodiscard]] Status follow_choice(std::int64_t now_ns);
  [[nodiscard]] Status on_own_role(const wire::NodeStatus& status);
  void warn_of_claim(const wire::NodeStatus& status);
  [[nodiscard]] Status given_to_another() const;
  void compare_builds(const wire::NodeStatus& status);
  [[nodiscard]] bool must_read(wire::Role reader, wire::Topic topic) const noexcept;
  bool is_decoded(bool is_it) noexcept {
    if (!is_it) ++refusals_.undecodable;
    return is_it;
  }
  [[nodiscard]] bool has_acknowledged(wire::Role reader, wire::Topic topic) const noexcept;

  wire::Role role_;
  transport::Transport& transport_;
  std::vector<wire::Topic> step_topics_;
  std::optional<wire::SessionId> only_;
  Identity identity_;
  wire::SessionDescription session_;
  bool has_session_ = false;
  std::uint32_t epoch_ = 0;
  std::uint32_t incarnation_ = 0;
  wire::NodeStatus status_;
  bool status_changed_ = false;
  std::string reason_;  // whole text; the message carries its beginning
  bool is_aside_ = false;
  bool is_withdrawn_ = false;
  wire::NodeStatus received_status_;                // the one that is being taken; its texts keep their memory
  std::vector<wire::NodeStatus> pending_statuses_;  // arrived before the session's description
  std::vector<std::string> warnings_;
  PeerWatch peers_;
  // The last status of a second process of a role: io may choose that one, or give the first one up.
  std::array<std::optional<wire::NodeStatus>, wire::kRoles> claimants_;
  Refusals refusals_;
  Status send_failure_;
  std::int64_t next_probe_ns_ = 0;
  bool has_warned_of_claim_ = false;
  bool was_chosen_ = false;  // io has named this process once
  std::vector<std::byte> buffer_;
};

}  // namespace slew::node
