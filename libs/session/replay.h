// SPDX-License-Identifier: Apache-2.0
// Computes a recorded session again, from its INIT and its ticks, and compares the state's hash at every step.
//
// The physics runs in this process without nodes and messages (direct_session.h). Equal hashes in every sample mean
// that every bit of every state was the same. Another build, C library or family of processors may differ in the last
// bit: the output names the recording's build.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/status.h"
#include "core/time.h"
#include "io_node/saved_session.h"
#include "recording/reader.h"
#include "transport/wire.h"

namespace slew::session {

enum class OnDifference : std::uint8_t { stop, count };

struct ReplayResult {
  StepIndex steps = 0;  // computed, over all epochs
  std::uint32_t epochs = 0;
  std::uint64_t compared = 0;  // samples whose hash was compared
  std::uint64_t different = 0;
  std::uint64_t unrecorded = 0;        // computed steps without a recorded sample
  std::uint64_t unreached_steps = 0;   // recorded ticks that were not computed
  std::uint64_t unreached_hashes = 0;  // recorded samples of steps that were not computed
  std::string end;                     // name of the first tick that was not reached; empty: all were
  double compute_time = 0;             // s
  std::vector<std::string> gaps;       // in the ticks, behind which states follow; what is between was not compared
  std::string problem;                 // first difference, or gap without states behind it, by name; empty: none
  [[nodiscard]] bool is_equal() const noexcept { return problem.empty() && different == 0; }
  // Every recorded step and hash was reached.
  [[nodiscard]] bool is_whole() const noexcept { return unreached_steps == 0 && unreached_hashes == 0 && gaps.empty(); }
};

// End of the computed part of a recording, and the session's states there.
struct ReplayEnd {
  std::optional<std::uint32_t> epoch;  // none: the last one of the recording
  StepIndex step = 0;                  // of that epoch; replay continues to the next one at which all nodes exchange
  io_node::SavedSession saved;
};

// Throws Failure when the recording lacks its scene or its ticks.
// assets: folder of the files that belong to the scene; the files in the recording's manifest must be there unchanged.
// end: null computes everything; otherwise replay stops at its step, and sets the step that was reached and the saved
// states.
[[nodiscard]] ReplayResult replay(const recording::Reader& reader, OnDifference on_difference,
                                  const std::string& assets, ReplayEnd* end = nullptr);

}  // namespace slew::session
