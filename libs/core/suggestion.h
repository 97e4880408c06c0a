// SPDX-License-Identifier: Apache-2.0
// The name that was probably meant: the nearest candidate by edit distance, ties broken by the alphabet.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace slew {

// Insertions, deletions, substitutions and swaps of neighbours (optimal string alignment), letters compared without
// case.
[[nodiscard]] std::size_t edit_distance(std::string_view a, std::string_view b);

// Nearest candidate when it is near enough (about one edit in three letters), else empty. Deterministic in any order.
[[nodiscard]] std::string closest(std::string_view word, const std::vector<std::string_view>& candidates);

}  // namespace slew
