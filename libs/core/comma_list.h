// SPDX-License-Identifier: Apache-2.0
// Lists as headers of HTTP have them: entries separated by commas, with blanks around them (RFC 9110, 5.6.1).
#pragma once

#include <algorithm>
#include <string_view>

namespace slew {

// Removes the first entry from the list and returns it without its blanks. An empty list has no entry more.
[[nodiscard]] inline std::string_view take_listed(std::string_view& list) noexcept {
  constexpr std::string_view kBlanks = " \t";
  std::string_view one = list.substr(0, list.find(','));
  list.remove_prefix(std::min(list.size(), one.size() + 1));
  one.remove_prefix(std::min(one.size(), one.find_first_not_of(kBlanks)));
  return one.substr(0, one.find_last_not_of(kBlanks) + 1);
}

}  // namespace slew
