// SPDX-License-Identifier: Apache-2.0
// States of the physics nodes that io_node keeps: it saves and loads a session from them, and gives them to a process
// that replaces a lost node.
//
// A session with session.rejoin holds the role of a lost physics node. A replacement receives the newest checkpoint
// that is old enough to resend every sample that another node, or the recorder, may still need.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "io_node/requests.h"
#include "io_node/sample_progress.h"
#include "io_node/session_inputs.h"
#include "node/checkpoint.h"
#include "node/resend_clock.h"
#include "node/session_member.h"

namespace slew::io_node {

// Longest wait for the states of all nodes; the session then continues without being saved.
inline constexpr SimDuration kSaveTimeout = milliseconds(5000);
// Longest time from a request to load to the last part of its states.
inline constexpr SimDuration kUploadTimeout = milliseconds(2000);

// End of a refusal while a role is held.
inline constexpr const char* kRepeatLater = "; repeat the request when a replacement has come";

class StateKeeper {
 public:
  StateKeeper(const IoConfig& config, node::SessionMember& member, SessionInputs& inputs);

  // An epoch begins at this step; states and replacements of the one before are dropped.
  void begin_epoch(StepIndex begin);
  [[nodiscard]] StepIndex begin_step() const noexcept { return begin_step_; }
  // The first epoch continues saved states. Error: io's own cannot be loaded.
  [[nodiscard]] Status resume(const ResumeState& resume);

  // A part of a checkpoint; an answer if its node cannot save the state that is requested. n: the next tick.
  [[nodiscard]] std::optional<ControlAnswer> receive_checkpoint(std::span<const std::byte> bytes, StepIndex n);
  // Publishes the state of the role at the requested step; without a step, the state for a replacement, or the one at
  // the begin of the epoch. False: there is none.
  bool publish_state(const wire::ResendRequest& request);

  // ---- saving
  [[nodiscard]] bool is_saving() const noexcept { return saving_.has_value(); }
  // The tick of step n waits for states.
  [[nodiscard]] bool holds_tick(StepIndex n) const noexcept { return saving_ && n >= saving_->step; }
  [[nodiscard]] std::int64_t request_due_ns() const noexcept { return saving_->resend.due_ns(); }
  // Begins to save the session, at step n or soon after. stops_at: step of the pause. Returns the reason of a refusal.
  [[nodiscard]] std::string begin_saving(const wire::ControlRequest& request, StepIndex n,
                                         std::optional<StepIndex> stops_at, std::int64_t now_ns);
  // Begins to collect the states of step n, for replacements.
  void begin_collecting(StepIndex n, std::int64_t now_ns);
  struct Progress {
    bool is_over = false;  // false: the tick of the step must wait
    std::optional<ControlAnswer> answer;
  };
  // Requests missing states. Once all are there, or the time is over, the saving ends.
  [[nodiscard]] Progress advance_saving(StepIndex n, std::int64_t now_ns);

  // ---- loading
  [[nodiscard]] bool is_loading() const noexcept { return upload_.load_request.has_value(); }
  // A part of an uploaded state, from an observer: not a member of the session, identified by its request's number.
  void receive_upload(std::span<const std::byte> bytes);
  // Returns the reason of a refusal.
  [[nodiscard]] std::string begin_loading(const wire::ControlRequest& request, std::int64_t now_ns);
  // Answer once the upload is whole or must be refused. If accepted: take_upload(), begin_epoch() at
  // its step, and load() follow.
  [[nodiscard]] std::optional<ControlAnswer> advance_loading(bool is_running, StepIndex n, std::int64_t now_ns);
  struct Upload {
    std::uint64_t request = 0;
    std::array<node::CheckpointParts, wire::kRoles> parts;
    std::optional<wire::ControlRequest> load_request;  // received before the last part
    std::int64_t deadline_ns = 0;
  };
  [[nodiscard]] Upload take_upload() { return std::exchange(upload_, {}); }
  void load(const Upload& upload);
  // The request is being executed.
  [[nodiscard]] bool is_under_way(const wire::ControlRequest& request) const noexcept {
    return (saving_ && saving_->request == request) || upload_.load_request == request;
  }

  // ---- held roles
  [[nodiscard]] bool is_holding() const noexcept { return !held_.empty(); }
  [[nodiscard]] bool is_held(wire::Role role) const noexcept { return find_held(role) != nullptr; }
  // A role is held, or a replacement has not caught up with the ticks.
  [[nodiscard]] bool is_replacing() const noexcept;
  // Status text of the role that has been held longest. Pre-condition: is_holding().
  [[nodiscard]] std::string held_text() const { return text_of(held_.front()); }
  // Holds the role of a lost process, with a warning. False: it cannot be replaced.
  [[nodiscard]] bool hold_role(wire::Role role, StepIndex n, const SampleProgress& samples, std::int64_t now_ns);
  // A sample of this step was received. True: with it a replacement has caught up with the ticks.
  bool catches_up(wire::Role role, StepIndex step) noexcept;
  struct HeldChange {
    enum class Kind : std::uint8_t { rejected, filled, expired } kind;
    wire::Role role;
    std::string reason;  // cause of the session's end, if the time has expired
  };
  // Replacements that are ready, or have ended; roles whose time has expired. Warns of the first two.
  [[nodiscard]] std::vector<HeldChange> watch_held(StepIndex n, std::int64_t now_ns);

 private:
  // Role of a lost process, held for a replacement.
  struct HeldRole {
    wire::Role role = wire::Role::io;
    std::string lost;       // description of the lost process
    StepIndex lost_at = 0;  // next tick at that time
    StepIndex from = 0;     // step of the state for the replacement
    std::int64_t deadline_ns = 0;
  };
  // A replacement: it can resend its samples from this step on, and has caught up with the ticks when its newest sample
  // is that of step `until` (kJoinStep: it has).
  struct Replaced {
    StepIndex from = 0;
    StepIndex until = kJoinStep;
  };
  struct Saving {
    wire::ControlRequest request;  // number 0: without an answer
    StepIndex step = 0;
    std::int64_t deadline_ns = 0;  // set when the tick is first held
    node::ResendClock resend;
    bool is_published = true;  // false: the states are only kept for replacements
  };

  [[nodiscard]] node::KeptCheckpoints& kept(wire::Role role) noexcept { return kept_[static_cast<std::size_t>(role)]; }
  [[nodiscard]] const node::KeptCheckpoints& kept(wire::Role role) const noexcept {
    return kept_[static_cast<std::size_t>(role)];
  }
  [[nodiscard]] Replaced& replaced(wire::Role role) noexcept { return replaced_[static_cast<std::size_t>(role)]; }
  [[nodiscard]] const Replaced& replaced(wire::Role role) const noexcept {
    return replaced_[static_cast<std::size_t>(role)];
  }
  // Reason why no saving or loading can begin now; empty: none.
  [[nodiscard]] std::string obstacle() const;
  [[nodiscard]] std::optional<wire::Role> unsaved() const noexcept;
  void publish_saved();
  [[nodiscard]] const HeldRole* find_held(wire::Role role) const noexcept;
  [[nodiscard]] bool has_no_process(wire::Role role) const noexcept;
  [[nodiscard]] bool are_bound(wire::Role role, wire::Role other) const noexcept;
  [[nodiscard]] bool is_suitable(wire::Role role, StepIndex step, StepIndex n,
                                 const SampleProgress& samples) const noexcept;
  [[nodiscard]] const node::Checkpoint* state_for(wire::Role role, StepIndex n,
                                                  const SampleProgress& samples) const noexcept;
  [[nodiscard]] std::string text_of(const HeldRole& held) const;

  const IoConfig& config_;
  node::SessionMember& member_;
  SessionInputs& inputs_;
  StepIndex begin_step_ = 0;  // first step of the epoch
  std::array<node::KeptCheckpoints, wire::kRoles> kept_;
  std::vector<HeldRole> held_;
  std::array<Replaced, wire::kRoles> replaced_;
  std::optional<Saving> saving_;
  Upload upload_;
  wire::StatePart part_;  // the message that is being received
};

}  // namespace slew::io_node
