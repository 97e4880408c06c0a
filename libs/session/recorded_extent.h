// SPDX-License-Identifier: Apache-2.0
// How far the session of a recording goes without a gap: ticks and samples of every node.
#pragma once

#include <cstdint>
#include <optional>

#include "core/time.h"
#include "recording/reader.h"

namespace slew::session {

struct RecordedExtent {
  std::uint32_t epoch = 0;              // the newest
  std::optional<StepIndex> first_step;  // step with which it begins; none: the messages that hold it are lost
  StepIndex complete_to = -1;           // every step of it up to here; first_step - 1: not even the first
  StepIndex last_step = -1;             // newest tick or sample of it
  std::uint64_t lost = 0;               // ticks and samples in front of the newest of their kind, all epochs
};

// A recording without samples is counted by its ticks; one without ticks has no extent.
// An epoch begins with the step of its states, else with that of INIT; without either, and without step 0, it is
// counted from step 0 on. Throws Failure.
[[nodiscard]] RecordedExtent recorded_extent(const recording::Reader& reader);

}  // namespace slew::session
