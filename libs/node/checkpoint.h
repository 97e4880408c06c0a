// The state of one node at one step as bytes: made by a physics node, sent in parts, kept by io, given to who takes the
// role over.
//
// The bytes of a physics node: a layout number, what its sample says beside the physics (wire::SampleState), XXH3 of
// these, then what Subsystem::save() gave. Little-endian raw bits of this processor family. Only the same build need
// read them: the hash of the state that is loaded is held against that of the state that was saved.
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

// Steps between two checkpoints, at least. A node that rejoins computes up to two of these intervals again.
inline constexpr StepIndex kCheckpointEvery = 128;

// Steps between two checkpoints of nodes that have all exchanged after every `unit` steps: two that begin anew must
// find each other's samples from their common step on.
[[nodiscard]] constexpr StepIndex checkpoint_interval(StepIndex unit) noexcept {
  return (kCheckpointEvery + unit - 1) / unit * unit;
}

// Checkpoints of a role that io keeps. The oldest is at most 5 intervals behind the ticks (with what is on its way),
// within the kSentDepth steps that everybody can say again.
inline constexpr std::size_t kKeptCheckpoints = 4;

// No state is longer; of a part that says so nothing is kept.
inline constexpr std::size_t kMaxStateBytes = std::size_t{4} << 20;

struct Checkpoint {
  StepIndex step = kJoinStep;
  std::uint64_t state_hash = 0;
  std::vector<std::byte> bytes;
};

// ---- bytes of a physics node ------------------------------------------------------------------------------------

// Replaces the contents of `checkpoint`; no allocation once it has the capacity. said: of the sample of this step.
void save_node(const coupling::Subsystem& subsystem, const wire::SampleState& said, StepIndex step,
               Checkpoint& checkpoint);

// Error (bad_input): the bytes are damaged, of another scene or of another program; the subsystem is then as after
// reset().
[[nodiscard]] Status load_node(const Checkpoint& checkpoint, coupling::Subsystem& subsystem, wire::SampleState& said,
                               coupling::OwnSample& sample);

// ---- parts ------------------------------------------------------------------------------------------------------

// Says a state part by part, so that no step has to say all of it.
class CheckpointSender {
 public:
  // The place to put a new state into; what has not been said of the one before is left out.
  [[nodiscard]] Checkpoint& next() noexcept {
    at_ = 0;
    return checkpoint_;
  }
  [[nodiscard]] bool has_more() const noexcept { return at_ < checkpoint_.bytes.size(); }
  [[nodiscard]] StepIndex step() const noexcept { return checkpoint_.step; }
  // Says the next part, of the own role.
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

// Says all parts of a role's state on a topic. epoch and writer are the member's.
void send_checkpoint(SessionMember& member, wire::Topic topic, wire::Role role, const Checkpoint& checkpoint,
                     std::uint64_t request = 0);

// Puts parts together, of one state at a time: a part of another state begins anew. A part that has no place in the
// state that it says it is of changes nothing.
class CheckpointParts {
 public:
  // True when this part made the state whole.
  bool take(const wire::StatePart& part);
  // This very part has been taken.
  [[nodiscard]] bool has(const wire::StatePart& part) const noexcept;
  [[nodiscard]] bool is_whole() const noexcept { return is_begun_ && missing_ == 0; }
  [[nodiscard]] const Checkpoint& checkpoint() const noexcept { return checkpoint_; }
  [[nodiscard]] Checkpoint& checkpoint() noexcept { return checkpoint_; }
  void clear() noexcept { is_begun_ = false; }

 private:
  Checkpoint checkpoint_;
  std::vector<bool> has_;  // by part
  std::size_t missing_ = 0;
  bool is_begun_ = false;

  [[nodiscard]] bool is_of_this(const wire::StatePart& part) const noexcept;
};

// The last states of one role.
class KeptCheckpoints {
 public:
  // Takes a part of what the role says.
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
