// A session as processes: starts the nodes that the scene needs, watches over them, ends them in order.
#pragma once

#include "session/run_outcome.h"
#include "io_node/session_scene.h"

namespace slew::cli {

[[nodiscard]] RunOutcome run_distributed(const RunOptions& options, const io::SessionScene& session);

}  // namespace slew::cli
