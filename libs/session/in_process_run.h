// A session in one process, all nodes on one thread: for the debugger, for speed, and as the reference that a
// distributed run must equal bit for bit.
#pragma once

#include "io_node/session_scene.h"
#include "session/run_outcome.h"

namespace slew::session {

[[nodiscard]] RunOutcome run_in_process(const RunOptions& options, const io_node::SessionScene& session,
                                        RunWatcher& watcher);

}  // namespace slew::session
