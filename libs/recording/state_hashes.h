// SPDX-License-Identifier: Apache-2.0
// The topic "state_hashes" of a recording without samples: what is left of them is enough to verify a replay.
//
// A message has the digest of one writer's state hashes at up to kHashedSteps steps: the sum, modulo 2^64, of the XXH3
// of each step with its hash. A sum does not depend on the order, and parts of a block that came apart add up: a reader
// adds messages of the same role, epoch and block. Not on the wire; a CDR message like all others.
#pragma once

#include <cstdint>

#include "core/time.h"
#include "recording/byte_order.h"

namespace slew::recording {

inline constexpr const char* kStateHashesTopic = "state_hashes";
inline constexpr const char* kStateHashesType = "slewring::StateHashes";

// Steps of a block: the steps with the same quotient by it. Eight bytes of a hash are not compressible, so that a
// shorter block makes a larger file; a longer one names the place of a difference less exactly.
inline constexpr StepIndex kHashedSteps = 20;
[[nodiscard]] constexpr StepIndex hash_block_of(StepIndex step) noexcept {
  return step / kHashedSteps;
}

// The type's definition for the schema, to follow the module of the wire's types.
inline constexpr const char* kStateHashesIdl = R"idl(
// Digest of the state hashes of a writer's samples at steps of [first_step, last_step]: docs/recording-format.md. Only
// in recordings.
module slewring {
@final struct StateHashes {
  int64 first_step;
  int64 last_step;
  uint32 role;                          // Role
  uint32 epoch;
  uint64 digest;
  uint32 count;                         // of samples
};
};
)idl";

struct StateHashes {
  StepIndex first_step = 0;
  StepIndex last_step = 0;
  std::uint32_t role = 0;
  std::uint32_t epoch = 0;
  std::uint64_t digest = 0;
  std::uint32_t count = 0;

  void add(StepIndex step, std::uint64_t state_hash) noexcept;
  // The first part gives the role and the epoch.
  void add(const StateHashes& part) noexcept;
};

// The sample on disk, with its encapsulation header.
void encode_state_hashes(const StateHashes& hashes, Bytes& out);
// False when it is not well formed.
[[nodiscard]] bool decode_state_hashes(ByteSpan payload, StateHashes& hashes) noexcept;

}  // namespace slew::recording
