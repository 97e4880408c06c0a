// SPDX-License-Identifier: Apache-2.0
// Code of a small problem for each size: with the size as a constant the compiler unrolls the loops and keeps the
// values in registers. Operations and their order do not change, so the bits do not either.
#pragma once

#include <cstddef>
#include <type_traits>

namespace slew::math {

// f(n) with n as a std::integral_constant from 1 to Most, otherwise as it is.
template <std::size_t Most, typename F>
[[gnu::always_inline]] inline auto with_fixed_size(std::size_t n, const F& f) noexcept {
  if constexpr (Most == 0) {
    return f(n);
  } else {
    if (n == Most) return f(std::integral_constant<std::size_t, Most>{});
    return with_fixed_size<Most - 1>(n, f);
  }
}

}  // namespace slew::math
