// SPDX-License-Identifier: Apache-2.0
// A session from its scene, or from saved states, to its summary: `slewring run`, and a session that continues a
// replay.
#pragma once

#include "io_node/session_scene.h"
#include "options/options.h"
#include "session/run.h"

namespace slew::cli {

class WindowProcess;

// Runs the session, records it, and prints its summary. window: is started beside its nodes; null: none.
[[nodiscard]] ExitCode run_session(session::RunOptions options, const io_node::SessionScene& session,
                                   WindowProcess* window = nullptr);

// --out, --keep-free, --join-timeout, --rt, --cpu, --quiet.
void add_running_options(options::Command& verb, session::RunOptions& options);

}  // namespace slew::cli
