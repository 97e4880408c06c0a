// SPDX-License-Identifier: Apache-2.0
// Selection of variables by name or pattern (* any characters, ? one character), for scenes and the command line.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace slew::scene {

// Indices of the names that match at least one pattern, ascending.
[[nodiscard]] std::vector<std::uint32_t> matching(std::span<const std::string> patterns,
                                                  std::span<const std::string> names);

// The patterns without a matching name.
[[nodiscard]] std::vector<std::string> unmatched(std::span<const std::string> patterns,
                                                 std::span<const std::string> names);

// True if some name can match both patterns.
[[nodiscard]] bool can_meet(std::string_view a, std::string_view b);

// "there is no variable 'Cyl_Lft.force'; did you mean 'Cyl_Lift.force'?"
[[nodiscard]] std::string no_variable_text(const std::string& pattern, std::span<const std::string> names);

// The variables selected by names and patterns, in the order of the patterns, without repetition. Throws Failure
// (bad_input) for a pattern without a match, with a suggested name.
[[nodiscard]] std::vector<std::string> choose(std::span<const std::string> patterns,
                                              std::span<const std::string> names);

}  // namespace slew::scene
