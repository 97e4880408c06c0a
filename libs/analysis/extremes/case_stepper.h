// SPDX-License-Identifier: Apache-2.0
// One run of a hard case, step by step in this process.
#pragma once

#include <cstdint>

#include "analysis/extremes/case_trace.h"
#include "analysis/extremes/cases.h"
#include "analysis/extremes/judge.h"
#include "scene/scene.h"

namespace slew::analysis {

// compared: without what the comparison run leaves out. kicked: the same with one sample a step late, a small kick.
enum class Strictness : std::uint8_t { whole, compared, kicked };

struct SteppedCase {
  Measures measures;
  CaseTrace trace;
};

// Ends early at a failure, an alarm or a limit of processor time, which the measures state. scene: that of the case.
[[nodiscard]] SteppedCase step_case(const ExtremeCase& one, const scene::Scene& scene, Strictness strictness);

// Step at which the inputs are full and one sample of the kicked run is late. H: step [s].
[[nodiscard]] StepIndex kick_of(const ExtremeCase& one, double H);

}  // namespace slew::analysis
