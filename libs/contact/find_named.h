// SPDX-License-Identifier: Apache-2.0
// A definition by its name.
#pragma once

#include <algorithm>
#include <string_view>
#include <vector>

namespace slew::contact {

// Null if no definition has the name.
template <typename Def>
[[nodiscard]] const Def* find_named(const std::vector<Def>& defs, std::string_view name) {
  const auto found = std::find_if(defs.begin(), defs.end(), [&](const Def& def) { return def.name == name; });
  return found == defs.end() ? nullptr : &*found;
}

}  // namespace slew::contact
