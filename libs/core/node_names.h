// SPDX-License-Identifier: Apache-2.0
// Names of a session's nodes, in the order of wire::Role, the sensors last: on command lines, in scenes and in
// messages.
#pragma once

#include <string_view>

namespace slew {

inline constexpr std::string_view kNodeNames[] = {"io", "mechanics", "hydraulics", "flex", "recorder", "sensor"};

}  // namespace slew
