// SPDX-License-Identifier: Apache-2.0
// States that a physics node exchanges with io: its checkpoints, which io keeps, and the state of its role that it
// takes over instead of INIT (bytes: node/checkpoint.h).
//
// In a session that can be rejoined a node saves a checkpoint every checkpoint_interval() steps and publishes one part
// of it with each step after that, so that the cost of a step is bounded. On io's request it publishes the whole state
// at once.
#pragma once

#include <cstddef>
#include <span>

#include "node/checkpoint.h"
#include "node/session_member.h"
#include "node/subsystem_factory.h"

namespace slew::node {

class StateTransfer {
 public:
  // built: outlives this object; complete before the first state.
  explicit StateTransfer(const BuiltSubsystem& built) noexcept : built_(built) {}

  // ---- saving
  // io requests the state at this step, and holds the ticks until it has received it.
  void request(StepIndex step) noexcept { requested_ = step; }
  [[nodiscard]] bool is_requested(StepIndex step) const noexcept { return step == requested_; }
  // To be called at every step n, after its sample. published: the state in that sample.
  void save_if_due(SessionMember& member, StepIndex n, const wire::SampleState& published);
  // Publishes the whole state at step n; a part without bytes when the subsystem cannot save.
  void publish_state(SessionMember& member, StepIndex n, const wire::SampleState& published);

  // ---- taking over
  // A message of the topic state, of the present session and epoch.
  void receive_part(std::span<const std::byte> bytes, SessionMember& member);
  [[nodiscard]] bool has_state() const noexcept { return taken_over_.is_whole(); }
  // Loads the received state into the subsystem. n, published, own: step, state and sample of that state. Error: as
  // load_node(). Pre-condition: has_state().
  Status load(const SessionMember& member, StepIndex& n, wire::SampleState& published, coupling::OwnSample& own);
  // Step of the session when this node joined: ticks and samples before it can be requested.
  [[nodiscard]] StepIndex caught_up_at() const noexcept { return caught_up_at_; }

  // A new epoch begins.
  void restart() noexcept;

 private:
  static constexpr StepIndex kNoStep = -1;

  const BuiltSubsystem& built_;
  CheckpointSender checkpoint_;
  StepIndex requested_ = kNoStep;
  CheckpointParts taken_over_;
  wire::StatePart part_;
  StepIndex caught_up_at_ = 0;
};

}  // namespace slew::node
