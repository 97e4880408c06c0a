// What every node of a session does alike: who am I, who are the others, have we heard each other, is anybody gone.
//
// JOIN: a writer repeats step -1 on each of its step topics until every required reader has reported, in its
// NodeStatus, that it heard this writer there. "Matched" at the transport proves nothing; only a received message does.
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
#include "node/sent_cache.h"
#include "transport/cdr/codec.h"
#include "transport/transport.h"
#include "transport/wire.h"

namespace slew::node {

inline constexpr SimDuration kJoinTimeout = {10'000'000'000};
// of nodes that run in turns in one thread: none of them can be missing, and the machine may take its time
inline constexpr SimDuration kNoTimeout = {100LL * 365 * 86400 * 1'000'000'000};
inline constexpr SimDuration kProbeInterval = {20'000'000};
inline constexpr SimDuration kSilentAfter = {300'000'000};  // named, everybody holds
// between two looks: what goes beyond is the silence of the process that looks and nobody else's
inline constexpr SimDuration kUsualLook = {100'000'000};
inline constexpr SimDuration kStoodStill = {1'000'000'000};  // between two looks: the others may have given one up
inline constexpr SimDuration kLastWords = {20'000'000};      // on their way when a process is seen to be gone
inline constexpr SimDuration kProcessLook = {1'000'000};     // between two looks whether processes are there
inline constexpr SimDuration kResendAfter = {3'000'000};     // a missing step is asked for
inline constexpr SimDuration kResendAtMost = {100'000'000};  // longest pause between two requests
inline constexpr SimDuration kHealthInterval = {100'000'000};
inline constexpr SimDuration kLinger = {2'000'000'000};  // answers resends after its own end, at least

// Messages that were received but not applied, by cause.
struct Refusals {
  // something is wrong: a damaged message, a foreign session, two processes of one role, a writer that runs ahead
  std::uint64_t undecodable = 0;
  std::uint64_t other_session = 0;
  std::uint64_t unexpected_writer = 0;
  std::uint64_t too_far_ahead = 0;
  // part of every healthy session
  std::uint64_t early = 0;        // before this node knew the session or the writer; said again until JOIN is done
  std::uint64_t other_epoch = 0;  // on their way while the session was reset
  std::uint64_t duplicate = 0;    // of a step that is there or done: an answer to a resend that came twice
  [[nodiscard]] std::uint64_t refused() const noexcept {
    return undecodable + other_session + unexpected_writer + too_far_ahead;
  }
};

// What is known of another role of the session.
struct Peer {
  bool is_known = false;
  wire::NodeStatus status;
  std::uint32_t incarnation = 0;   // of the process that holds the role
  std::int64_t last_heard_ns = 0;  // monotonic; without the time in which this process stood still
  std::int64_t excused_ns = -1;    // what last_heard_ns became by that, until something is heard
  ProcessWatch process;
  std::int64_t exit_seen_ns = 0;  // when the process was first seen to be gone; 0: it is there
  bool is_silent = false;         // named once
  bool is_lost = false;           // given up, or gone
  StepIndex step = kJoinStep;     // the next one to do, as its health says
  std::uint32_t step_epoch = 0;   // of that
  std::int64_t gone_ns = 0;       // when it was seen to be gone; 0: it is not
};

// gone: a physics node whose place the session holds for another process of its role.
enum class PeerEvent : std::uint8_t { none, silent, back, gone, lost };

// What a session's description means to a node that does not own it.
enum class SessionNews : std::uint8_t {
  none,
  begins,     // the session to take part in
  renewed,    // its owner says anew how it stands: processes that were given up, the step that it is at
  withdrawn,  // its owner takes it back: another session holds the name
};

// How a node finds its session.
struct JoinOptions {
  SimDuration session_timeout = milliseconds(30'000);  // longest wait for a session of the name
  SimDuration join_timeout = kJoinTimeout;             // longest wait for the other nodes of the session
  std::optional<wire::SessionId> session;              // takes part in this one only; none: in the first of the name
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
  [[nodiscard]] SessionNews news(const wire::SessionDescription& session) const noexcept;
  // Takes part in a session. NodeStatus messages that came before are taken now; returns a refusal when another
  // process holds this role.
  Status adopt(const wire::SessionDescription& session, std::int64_t now_ns);
  // Takes what the owner says anew. Places of processes that were given up are free for others.
  void renew(const wire::SessionDescription& session, std::int64_t now_ns);
  // This process has lost its role to another one, which it has not noticed.
  [[nodiscard]] bool is_given_up() const noexcept { return is_given_up(role_, incarnation_); }
  // The session has begun, or begins, at a step whose state io has.
  [[nodiscard]] bool has_state() const noexcept { return session_.header.step >= 0; }
  // Ok when the session speaks this program's protocol version.
  [[nodiscard]] Status problem_of_protocol() const;
  [[nodiscard]] bool has_session() const noexcept { return has_session_; }
  [[nodiscard]] const wire::SessionDescription& session() const noexcept { return session_; }
  // Silence after which the session gives a node up (session.give_up_after), and with its key for a message:
  // "2 s (session.give_up_after)".
  [[nodiscard]] SimDuration give_up_after() const noexcept { return {session_.give_up_ns}; }
  [[nodiscard]] std::string give_up_text() const;
  // How long this node answers resends after its own end, at most: others may be silent for a while and come back.
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

  // True when a message on this topic belongs to this session and comes from a process that holds a role which writes
  // the topic; counts it otherwise.
  [[nodiscard]] bool is_of_session(const wire::Header& header, wire::Topic topic) noexcept;
  // The same, and of the present epoch.
  [[nodiscard]] bool fits(const wire::Header& header, wire::Topic topic) noexcept;
  // True for the INIT tick with which io begins the next epoch.
  [[nodiscard]] bool begins_next_epoch(const wire::Header& header) const noexcept;
  [[nodiscard]] Refusals& refusals() noexcept { return refusals_; }

  // ---- state and status
  void set_state(wire::NodeState state) noexcept;
  [[nodiscard]] wire::NodeState state() const noexcept { return status_.state; }
  void set_step(StepIndex step) noexcept { status_.header.step = step; }
  void set_recorded_step(StepIndex step) noexcept { status_.recorded_step = step; }
  void fail(ExitCode code, std::string reason);
  // reason: who asked for it, when that was not this process's owner.
  void end(ExitCode code, std::string reason = "");
  // Ends without a word to the others: this process never held the role.
  void step_aside(ExitCode code, std::string reason);
  // Steps aside because its role was given to another process.
  void yield();
  // Steps aside because the session was withdrawn: is_withdrawn(), or failed when there is no other session for it.
  void withdraw();
  // This process may take part in the next session of the name, as a new node on a new transport.
  [[nodiscard]] bool is_withdrawn() const noexcept { return is_withdrawn_; }
  // Waits for somebody, and says for whom in its status; running again when the reason is gone.
  void hold(std::string reason);
  [[nodiscard]] ExitCode exit_code() const noexcept { return static_cast<ExitCode>(status_.exit_code); }
  [[nodiscard]] const std::string& reason() const noexcept { return reason_; }
  void mark_status_changed() noexcept { status_changed_ = true; }
  void publish_status_if_changed();

  // ---- others
  // Takes a NodeStatus or Health message. Returns a refusal when another process holds this role. Of several processes
  // of one role the one holds it whose status io took first. io publishes its choice: an entry of topic node_status in
  // `heard` of its own status, the last of a role, less those that were given up. Messages from the others are ignored.
  // No node becomes READY before io has chosen it, so that no status takes its role from it afterwards.
  Status on_node_status(std::span<const std::byte> bytes, std::int64_t now_ns);
  void on_health(std::span<const std::byte> bytes, std::int64_t now_ns);
  // io has chosen this process for its role.
  [[nodiscard]] bool holds_role() const noexcept { return holder(role_) == incarnation_; }
  [[nodiscard]] const Peer& peer(wire::Role role) const noexcept { return peers_[static_cast<std::size_t>(role)]; }
  // Looks for silent and lost required peers; at most one event per call, with the role it is about. Time in which this
  // process stood still is nobody's silence: once, until the peer is heard again.
  PeerEvent watch_peers(std::int64_t now_ns, wire::Role& about);
  // Why this node ends with a peer that is gone or has ended: `reason`, and what this process has to do with it when it
  // stood still itself or was not heard.
  [[nodiscard]] std::string end_text(wire::Role about, const std::string& reason) const;
  // A required role that has been named silent and has not come back.
  [[nodiscard]] std::optional<wire::Role> silent_peer() const noexcept;
  [[nodiscard]] std::string describe_peer(wire::Role role) const;
  // The named role has been silent for 0.3 s, for NodeStatus and logs.
  [[nodiscard]] std::string silence_text(wire::Role role) const;
  // What the user is to be told while the session goes on: warn()'s, and what differs between this program and a peer's
  // that may change the last bit of a result. Each once.
  void warn(std::string text) { warnings_.push_back(std::move(text)); }
  [[nodiscard]] std::vector<std::string> take_warnings();
  [[nodiscard]] bool all_required(wire::NodeState at_least) const noexcept;

  // ---- join
  void heard(const wire::Header& from, wire::Topic topic, std::int64_t now_ns);
  [[nodiscard]] bool is_heard_by_all() const noexcept;
  [[nodiscard]] bool is_heard_on(wire::Topic topic) const noexcept;
  [[nodiscard]] bool probe_is_due(std::int64_t now_ns) noexcept;
  [[nodiscard]] std::string missing_join_text();

  // ---- sending
  // Pre-condition: texts and lists of the message are within their caps.
  template <typename Message>
  void publish(wire::Topic topic, const Message& message) {
    const bool is_encoded = transport::encode(message, buffer_);
    SLEW_CHECK(is_encoded);
    send(topic, buffer_);
  }
  void send(wire::Topic topic, std::span<const std::byte> bytes) noexcept;
  // The first message that could not be sent; ok: all were. The node ends the session for it.
  [[nodiscard]] const Status& send_failure() const noexcept { return send_failure_; }

 private:
  [[nodiscard]] Status take_status(const wire::NodeStatus& status, std::int64_t now_ns);
  [[nodiscard]] bool is_given_up(wire::Role role, std::uint32_t incarnation) const noexcept;
  void forget_given_up(std::int64_t now_ns);
  [[nodiscard]] bool may_be_replaced(wire::Role role) const noexcept;
  [[nodiscard]] PeerEvent look_at(Peer& peer, wire::Role role, std::int64_t now_ns) noexcept;
  [[nodiscard]] bool is_in_session(const wire::Header& header) const noexcept;
  void excuse_peers(std::int64_t now_ns) noexcept;
  [[nodiscard]] bool is_writer(const wire::Header& header, wire::Topic topic) const noexcept;
  [[nodiscard]] std::string found_writers(wire::Topic topic);
  [[nodiscard]] std::optional<std::uint32_t> holder(wire::Role role) const noexcept;
  [[nodiscard]] bool may_hold(const wire::NodeStatus& status, const Peer& peer) const noexcept;
  [[nodiscard]] Status follow_choice(std::int64_t now_ns);
  [[nodiscard]] Status on_own_role(const wire::NodeStatus& status);
  void tell_of_claim(const wire::NodeStatus& status);
  [[nodiscard]] Status given_to_another() const;
  void compare_builds(const wire::NodeStatus& status);
  [[nodiscard]] bool must_read(wire::Role reader, wire::Topic topic) const noexcept;
  [[nodiscard]] bool has_heard_me(wire::Role reader, wire::Topic topic) const noexcept;

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
  std::string reason_;  // whole; the message carries its beginning
  bool is_aside_ = false;
  bool is_withdrawn_ = false;
  wire::NodeStatus heard_;                        // the one that is being taken; its texts keep their memory
  std::vector<wire::NodeStatus> early_statuses_;  // came before the session's description
  std::vector<std::string> warnings_;
  std::array<Peer, wire::kRoles> peers_;
  // The last status of another process of a role: io may have chosen that one, or give the first one up.
  std::array<std::optional<wire::NodeStatus>, wire::kRoles> rivals_;
  Refusals refusals_;
  Status send_failure_;
  std::int64_t next_probe_ns_ = 0;
  bool has_told_of_claim_ = false;
  bool was_chosen_ = false;          // io has named this process once
  std::int64_t processes_ns_ = 0;    // when their processes were looked for last
  std::int64_t watched_ns_ = 0;      // when the peers were looked at last
  std::int64_t stood_still_ns_ = 0;  // from one look to the next, when the others had time to give this process up
  std::int64_t stood_until_ns_ = 0;
  std::int64_t sending_ns_ = 0;      // spent in sending since the peers were looked at last
  std::int64_t sent_before_ns_ = 0;  // the same of the look before
  bool stood_sending_ = false;
  std::vector<std::byte> buffer_;
};

}  // namespace slew::node
