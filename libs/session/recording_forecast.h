// SPDX-License-Identifier: Apache-2.0
// About how large the recording of a scene becomes, before it is made.
//
// The messages of a step are known from the scene; how well they compress depends on how much the machine moves. The
// bytes of a number are those measured over the first 60 s of the truck crane, which moves for 12 s of them; a machine
// that never rests may need twice as much.
#pragma once

#include <cstddef>
#include <string>

#include "scene/scene.h"
#include "session/direct_session.h"

namespace slew::session {

struct RecordedNumbers {
  double samples = 0;    // numbers of all samples of a step, on average
  double messages = 0;   // ticks and samples of a step, on average
  double variables = 0;  // of all nodes, in one block each
  double blocks = 0;     // blocks of variables
};

// Pre-condition: the session is of this scene.
[[nodiscard]] RecordedNumbers recorded_numbers(const scene::Scene& scene, const DirectSession& session);

// Bytes of a second of the session's time.
[[nodiscard]] double recorded_bytes(const scene::Scene& scene, const RecordedNumbers& numbers);

// "recording: about 57 MB for 60 s, 3.4 GB an hour (recording.steps: all)"; a session without an end has no first part.
[[nodiscard]] std::string forecast_text(const scene::Scene& scene, double bytes_per_second);

}  // namespace slew::session
