// SPDX-License-Identifier: Apache-2.0
// Flags that the steps of a recording, or of a live session, have reported (core/step_report.h): a sentence for each
// flag that matters to a user, with the first step that raised it.
#pragma once

#include <string>
#include <vector>

#include "node/flag_counter.h"
#include "recording/reader.h"
#include "scene/scene.h"
#include "session/run.h"

namespace slew::analysis {

// Names of what samples name by number: volumes and components of the circuit's states in their order, sensors and
// contacts in the order of the scene.
struct OffenderNames {
  std::vector<std::string> states, sensors, contacts;
};

// Flags of the samples of mechanics, hydraulics and sensors: not converged, sub-step budget, clamp, energy from the
// coupling, cavitation and pressures beyond the oil's law with the volume's or line's name, deflections that are not
// small. Flags that occur in sound runs too, end stops and open relief valves, are left out. For a free-running session
// the sentences also count steps without a sample. With the names of the recorded scene. Throws Failure when it cannot
// be read.
[[nodiscard]] std::vector<std::string> explain_flags(const node::FlagCounter& flags, const recording::Reader& reader);
// Counts the flags of every recorded sample. Throws Failure when the recording cannot be read.
[[nodiscard]] node::FlagCounter recorded_flags(const recording::Reader& reader);
// A sentence for each flag that was counted.
[[nodiscard]] std::vector<std::string> flag_sentences(const node::FlagCounter& flags, SimDuration step,
                                                      const OffenderNames& names);
[[nodiscard]] std::vector<std::string> explain_flags(const node::FlagCounter& flags, const scene::Scene& scene);
// The same of the samples that were read while the session ran, and how many did not arrive.
[[nodiscard]] std::vector<std::string> explain_flags(const session::RunOutcome& outcome, const scene::Scene& scene);

}  // namespace slew::analysis
