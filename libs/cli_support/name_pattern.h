// Choosing variables by name or pattern (* any characters, ? one character), as scenes and the command line do.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace slew::cli_support {

// Indices of the names that at least one pattern fits, ascending.
[[nodiscard]] std::vector<std::uint32_t> matching(std::span<const std::string> patterns,
                                                  std::span<const std::string> names);

// The variables meant by names and patterns, in the order in which they are asked for, none twice. Throws Failure
// (bad_input) for a pattern that fits nothing, with the name that was probably meant.
[[nodiscard]] std::vector<std::string> choose(std::span<const std::string> patterns,
                                              std::span<const std::string> names);

}  // namespace slew::cli_support
