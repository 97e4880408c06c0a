// SPDX-License-Identifier: Apache-2.0
// One hard case of a scene, run in this process and judged; then the largest communication step that keeps its bounds.
#pragma once

#include <string>

#include "analysis/extremes/cases.h"
#include "core/json.h"
#include "scene/scene_options.h"

namespace slew::analysis {

struct CaseOutcome {
  Measures measures;
  Judgement judgement;
  Edge edge;
};

// Steps that are tried for the edge [s], by bisection: shorter steps than a stable one are assumed to be stable.
inline constexpr double kEdgeSteps[] = {0.1e-3, 0.2e-3, 0.5e-3, 1e-3, 2e-3, 5e-3, 10e-3, 20e-3};

// Throws Failure when the scene has no such case; a refusal of the case by the scene is an outcome.
[[nodiscard]] CaseOutcome run_case(const scene::SceneOptions& scene, const std::string& name);

[[nodiscard]] Json to_json(const CaseOutcome& outcome);

}  // namespace slew::analysis
