// SPDX-License-Identifier: Apache-2.0
// What a window needs before anything is started for it: a token, an address, a port.
#pragma once

#include <string>

#include "view_node/window_options.h"

namespace slew::view_node {

// The first line of a file; "" without one. Throws Failure (bad_input).
[[nodiscard]] std::string read_token(const std::string& path);

// The address is one, and leaves this machine only with a token. Throws Failure (bad_input).
void check_address(const std::string& listen, const std::string& token);

// All that would end the window at once: token, address, and whether its port is free just now. Throws Failure:
// bad_input, or resources for the port.
void check_door(const WindowOptions& options);

}  // namespace slew::view_node
