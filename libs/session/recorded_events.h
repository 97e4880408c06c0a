// SPDX-License-Identifier: Apache-2.0
// Events of a recorded session besides its steps: requests and io's replies, io's own actions (overruns, load
// shedding), changes of the holder of a controller's channel, events of sensors, and switched outputs that go on or
// off, which are computed from the recorded variables (docs/decisions/outputs-in-recordings.md). Requests that read a
// value, and were answered, change nothing and are left out.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/time.h"
#include "recording/reader.h"

namespace slew::session {

struct RecordedEvent {
  StepIndex step = 0;  // step from which it holds
  std::uint32_t epoch = 0;
  std::string text;
};

// In the order of publication; changes of outputs among them by their steps.
[[nodiscard]] std::vector<RecordedEvent> recorded_events(const recording::Reader& reader);

}  // namespace slew::session
