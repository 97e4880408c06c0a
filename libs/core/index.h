// SPDX-License-Identifier: Apache-2.0
// Indices of models are int, with -1 for "none"; containers count in std::size_t.
#pragma once

#include <cstddef>

namespace slew {

[[nodiscard]] constexpr std::size_t at(int index) noexcept {
  return static_cast<std::size_t>(index);
}

}  // namespace slew
