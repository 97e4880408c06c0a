// Names of a session's nodes, in the order of wire::Role: on command lines, in scenes and in messages.
#pragma once

#include <string_view>

namespace slew {

inline constexpr std::string_view kNodeNames[] = {"io", "mechanics", "hydraulics", "flex", "recorder"};

}  // namespace slew
