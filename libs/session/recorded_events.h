// What happened in a recorded session besides its steps: requests and io's answers, what io did by itself (overruns,
// load shedding), and who got and lost a controller's channel.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/time.h"
#include "recording/reader.h"

namespace slew::session {

struct RecordedEvent {
  StepIndex step = 0;  // from which it holds
  std::uint32_t epoch = 0;
  std::string text;
};

// In the order in which they were said.
[[nodiscard]] std::vector<RecordedEvent> recorded_events(const recording::Reader& reader);

}  // namespace slew::session
