// Choosing variables by name or pattern (* any characters, ? one character), as scenes and the command line do.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace slew::scene {

// Indices of the names that at least one pattern fits, ascending.
[[nodiscard]] std::vector<std::uint32_t> matching(std::span<const std::string> patterns,
                                                  std::span<const std::string> names);

// The patterns that fit none of the names.
[[nodiscard]] std::vector<std::string> unmatched(std::span<const std::string> patterns,
                                                 std::span<const std::string> names);

// Whether there may be a name that both patterns fit.
[[nodiscard]] bool can_meet(std::string_view a, std::string_view b);

// "there is no variable 'Cyl_Lft.force'; did you mean 'Cyl_Lift.force'?"
[[nodiscard]] std::string no_variable_text(const std::string& pattern, std::span<const std::string> names);

// The variables meant by names and patterns, in the order in which they are asked for, none twice. Throws Failure
// (bad_input) for a pattern that fits nothing, with the name that was probably meant.
[[nodiscard]] std::vector<std::string> choose(std::span<const std::string> patterns,
                                              std::span<const std::string> names);

}  // namespace slew::scene
