// The variables that io_node publishes of every session, whatever recording.variables says: of the inputs, of the
// session, and of what the physics nodes say of their steps.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "transport/wire.h"

namespace slew::io_node {

// In the order of the values. roles: of the session, as bits; those of physics nodes have variables.
[[nodiscard]] std::vector<wire::VariableEntry> own_variables(std::span<const std::string> inputs, std::uint32_t roles);

}  // namespace slew::io_node
