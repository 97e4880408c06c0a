// A session as processes: starts the nodes that the scene needs, watches over them, ends them in order.
#pragma once

#include "cli/run_outcome.h"
#include "scene/scene.h"

namespace slew::cli {

[[nodiscard]] RunOutcome run_distributed(const RunOptions& options, const scene::Scene& scene);

}  // namespace slew::cli
