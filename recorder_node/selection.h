// SPDX-License-Identifier: Apache-2.0
// What a recorder stores of a session's messages, as the scene's section `recording` has it.
//
// With steps: ticks the samples of the steps are replaced by digests of their state hashes, and the hash in a tick,
// which no replay compares, is 0. With steps: none ticks, samples and states are left out. INIT, a sample with events
// of sensors, and all messages that are not of a step stay as they are; of the health messages, ten a second of each
// node, one a second is stored, and each with another state.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/status.h"
#include "recording/chunk_builder.h"
#include "recording/session_identity.h"
#include "recording/state_hashes.h"
#include "transport/cdr/codec.h"
#include "transport/transport.h"
#include "transport/wire.h"

namespace slew::recorder_node {

struct RecordedPart {
  recording::RecordedSteps steps = recording::RecordedSteps::all;
  recording::ChunkCoding coding = recording::ChunkCoding::zstd;
  int significant_bits = 53;  // of a variable's value, 8 to 53
};

// From the scene of the session. Errors: bad_input when this program does not take its text.
[[nodiscard]] Status part_of_scene(const wire::SessionDescription& session, RecordedPart& part);

class Selection {
 public:
  explicit Selection(const RecordedPart& part = {}) : part_(part) {}

  struct Stored {
    std::span<const std::byte> bytes;                // valid until the next call; empty: the message is left out
    std::optional<recording::StateHashes> hashes{};  // to be stored beside it
  };
  [[nodiscard]] Stored take(const transport::Received& message);

  // The wall clock at the publisher as it is stored [ns]. Where values are rounded it has steps of 1024 ns: the noise
  // below would be a fifteenth of the file.
  [[nodiscard]] std::int64_t publish_time(std::int64_t source_ns) const noexcept;

  // Hashes that have not been given yet, of all writers.
  [[nodiscard]] std::vector<recording::StateHashes> take_rest();

  [[nodiscard]] const RecordedPart& part() const noexcept { return part_; }

 private:
  [[nodiscard]] Stored take_sample(const transport::Received& message);
  [[nodiscard]] Stored take_tick(const transport::Received& message);
  [[nodiscard]] Stored take_variables(const transport::Received& message);
  [[nodiscard]] Stored take_health(const transport::Received& message);
  [[nodiscard]] std::optional<recording::StateHashes> add_hash(const wire::Header& header, std::uint64_t state_hash);

  RecordedPart part_;
  std::array<recording::StateHashes, wire::kRoles> hashes_{};  // block of each writer that is not full
  wire::Tick tick_;
  wire::VariableBlock block_;
  wire::SensorMessage sensors_;
  wire::Health health_;
  struct KeptHealth {
    std::int64_t sent_ns = 0;  // 0: none yet
    wire::NodeState state{};
  };
  std::array<KeptHealth, wire::kRoles> kept_health_{};
  transport::ByteBuffer buffer_;
};

// The value with its first bits, 2 to 53 of them, to nearest, ties to even; the other bits are zero. Infinities, NaN
// and values that would become infinite stay as they are.
[[nodiscard]] double rounded_to_bits(double value, int bits) noexcept;

}  // namespace slew::recorder_node
