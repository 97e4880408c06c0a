// SPDX-License-Identifier: Apache-2.0
// Epoch and step of a time of a recording. After a reset or a load the time of the file is not that of the session.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/time.h"
#include "recording/reader.h"
#include "session/recorded.h"

namespace slew::session {

struct RecordedPlace {
  std::uint32_t epoch = 0;
  StepIndex step = 0;  // H times this is the session's own time
  bool operator==(const RecordedPlace&) const = default;
};

// The first step at or behind a time [ns] of the recording, by its ticks. Throws Failure when no tick of that time is
// recorded. Reads from that time on.
[[nodiscard]] RecordedPlace place_of(const recording::Reader& reader, std::uint64_t time_ns);

// Part of a recording's time that belongs to one epoch, by the recorded variables.
struct EpochTimes {
  std::uint32_t epoch = 0;
  std::uint64_t from_ns = 0, to_ns = 0;  // both included, of the recording
  StepIndex first_step = 0;              // of the block at from_ns
};
// The epochs with variables in this range, in their order. Throws Failure.
[[nodiscard]] std::vector<EpochTimes> epoch_times(const recording::Reader& reader, const TimeRange& range);

// The epoch of a range that must not have two: what is written of it has one time. Throws Failure with the times of
// each epoch. Without variables in the range: those of epoch 0, with no time.
[[nodiscard]] EpochTimes only_epoch(const recording::Reader& reader, const TimeRange& range);

// Time [ns] of the recording's first step: that of INIT and of messages without a step does not count.
[[nodiscard]] std::uint64_t begin_time_ns(const recording::Reader& reader);

}  // namespace slew::session
