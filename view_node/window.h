// SPDX-License-Identifier: Apache-2.0
// A gateway and its server in front of a live session or a recording, until the session ends or a stop is requested.
#pragma once

#include <functional>
#include <string>

#include "core/status.h"
#include "view_node/window_options.h"

namespace slew::view_node {

// report: takes a line for the user. Throws Failure.
[[nodiscard]] ExitCode run_window(const WindowOptions& options, const std::function<void(const std::string&)>& report);

}  // namespace slew::view_node
