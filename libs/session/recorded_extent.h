// How far the session of a recording goes without a gap: ticks and samples of every node.
#pragma once

#include <cstdint>
#include <optional>

#include "core/time.h"
#include "recording/reader.h"

namespace slew::session {

struct RecordedExtent {
  std::uint32_t epoch = 0;              // the newest
  std::optional<StepIndex> first_step;  // with which it begins; none: what tells it is lost
  StepIndex complete_to = -1;           // in it, every step up to here; first_step - 1: not even that one
  StepIndex last_step = -1;             // newest tick or sample of it
  std::uint64_t lost = 0;               // ticks and samples in front of the newest of their kind, all epochs
};

// An epoch begins with the step of its states, else with that of INIT; one that has lost both, and step 0, is counted
// from step 0 on.
// Throws Failure.
[[nodiscard]] RecordedExtent recorded_extent(const recording::Reader& reader);

}  // namespace slew::session
