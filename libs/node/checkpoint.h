// SPDX-License-Identifier: Apache-2.0
// The state of one node at one step as bytes: a physics node saves it and sends it in parts, io keeps it and sends it
// to the process that takes the role over.
//
// The bytes of a physics node: a layout number, the state in its sample (wire::SampleState), XXH3 of these, then the
// bytes of Subsystem::save(). Little-endian raw bits of this processor family. Only the same build needs to read them:
// the hash of the loaded state is compared with that of the saved state.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/status.h"
#include "core/time.h"
#include "coupling/subsystem.h"
#include "node/session_member.h"
#include "transport/wire.h"

namespace slew::node {

// Least number of steps between two checkpoints. A node that rejoins computes up to two of these intervals again.
inline constexpr StepIndex kCheckpointEvery = 128;

// Steps between two checkpoints of nodes that have all exchanged after every `unit` steps: two nodes that resume must
// find each other's samples from their common step on.
[[nodiscard]] constexpr StepIndex checkpoint_interval(StepIndex unit) noexcept {
  return (kCheckpointEvery + unit - 1) / unit * unit;
}

// Checkpoints of a role that io keeps. The oldest is at most 5 intervals behind the ticks (messages in flight
// included), within the kSentDepth steps that every node can resend.
inline constexpr std::size_t kKeptCheckpoints = 4;

struct Checkpoint {
  StepIndex step = kJoinStep;
  std::uint64_t state_hash = 0;
  std::vector<std::byte> bytes;
};

// ---- bytes of a physics node ------------------------------------------------------------------------------------

// Replaces the contents of `checkpoint`; no allocation once it has the capacity. published: the state in the sample of
// this step.
void save_node(const coupling::Subsystem& subsystem, const wire::SampleState& published, StepIndex step,
               Checkpoint& checkpoint);

// Error (bad_input): the bytes are damaged, of another scene or of another program; the subsystem is then as after
// reset().
[[nodiscard]] Status load_node(const Checkpoint& checkpoint, coupling::Subsystem& subsystem,
                               wire::SampleState& published, coupling::OwnSample& sample);

// ---- parts ------------------------------------------------------------------------------------------------------

// Publishes a state part by part, so that no step publishes all of it.
class CheckpointSender {
 public:
  // The place to put a new state into. Unpublished parts of the state before are dropped.
  [[nodiscard]] Checkpoint& next() noexcept {
    at_ = 0;
    return checkpoint_;
  }
  [[nodiscard]] bool has_more() const noexcept { return at_ < checkpoint_.bytes.size(); }
  [[nodiscard]] StepIndex step() const noexcept { return checkpoint_.step; }
  // Publishes the next part, as the state of the own role.
  void send_part(SessionMember& member);
  void send_rest(SessionMember& member) {
    while (has_more()) send_part(member);
  }

 private:
  Checkpoint checkpoint_;
  std::size_t at_ = 0;
  wire::StatePart part_;
};

// All parts of a role's state.
[[nodiscard]] std::vector<wire::StatePart> parts_of(const Checkpoint& checkpoint, const wire::Header& header,
                                                    wire::Role role, std::uint64_t request);

// Publishes all parts of a role's state on a topic. epoch and writer are the member's.
void send_checkpoint(SessionMember& member, wire::Topic topic, wire::Role role, const Checkpoint& checkpoint,
                     std::uint64_t request = 0);

// Assembles the parts of one state at a time: a part of another state starts again with that state. A part without a
// place in the state that it names is ignored.
class CheckpointParts {
 public:
  // True when this part completes the state.
  bool take(const wire::StatePart& part);
  // This part has been taken.
  [[nodiscard]] bool has(const wire::StatePart& part) const noexcept;
  [[nodiscard]] bool is_whole() const noexcept { return is_begun_ && missing_ == 0; }
  [[nodiscard]] const Checkpoint& checkpoint() const noexcept { return checkpoint_; }
  [[nodiscard]] Checkpoint& checkpoint() noexcept { return checkpoint_; }
  void clear() noexcept { is_begun_ = false; }

 private:
  Checkpoint checkpoint_;
  std::vector<bool> has_;  // received parts
  std::size_t missing_ = 0;
  bool is_begun_ = false;

  [[nodiscard]] bool is_of_this(const wire::StatePart& part) const noexcept;
};

// The last states of one role.
class KeptCheckpoints {
 public:
  // Takes a part of a state that the role published.
  void take(const wire::StatePart& part);
  void keep(const Checkpoint& checkpoint);
  // The newest whose step suits; else null.
  template <typename Suits>
  [[nodiscard]] const Checkpoint* newest(Suits&& suits) const {
    const Checkpoint* best = nullptr;
    for (const Checkpoint& kept : kept_) {
      if (kept.step >= 0 && (best == nullptr || kept.step > best->step) && suits(kept.step)) best = &kept;
    }
    return best;
  }
  // The oldest whose step suits; else null.
  template <typename Suits>
  [[nodiscard]] const Checkpoint* oldest(Suits&& suits) const {
    const Checkpoint* best = nullptr;
    for (const Checkpoint& kept : kept_) {
      if (kept.step >= 0 && (best == nullptr || kept.step < best->step) && suits(kept.step)) best = &kept;
    }
    return best;
  }
  [[nodiscard]] const Checkpoint* find(StepIndex step) const noexcept;
  void clear() noexcept;

 private:
  CheckpointParts parts_;
  std::array<Checkpoint, kKeptCheckpoints> kept_;  // step kJoinStep: the place is free
};

}  // namespace slew::node
