// SPDX-License-Identifier: Apache-2.0
// Events of a recorded session besides its steps: requests and io's replies, io's own actions (overruns, load
// shedding), changes of the holder of a controller's channel, and events of sensors. Requests that read a value, and
// were answered, change nothing and are left out.
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

// In the order of publication.
[[nodiscard]] std::vector<RecordedEvent> recorded_events(const recording::Reader& reader);

}  // namespace slew::session
