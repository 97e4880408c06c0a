// A session as processes: starts the nodes that the scene needs, watches over them, ends them in order.
#pragma once

#include "io_node/session_scene.h"
#include "session/run_outcome.h"

namespace slew::session {

[[nodiscard]] RunOutcome run_distributed(const RunOptions& options, const io_node::SessionScene& session,
                                         RunWatcher& watcher);

}  // namespace slew::session
