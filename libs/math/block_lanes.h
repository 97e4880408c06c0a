// SPDX-License-Identifier: Apache-2.0
// Small blocks by rows of whole lanes, with zeros behind their columns. Sums run along the lanes, term by term from
// zero, so that their bits are those of a scalar loop. Internal to the library.
#pragma once

#include <array>
#include <cstddef>
#include <cstring>
#include <type_traits>

#include "math/block_ldl.h"
#include "math/vector3.h"

namespace slew::math {

inline constexpr int kLanes = 4;

// Doubles of a row of so many columns.
[[nodiscard]] constexpr int stride_of(int columns) noexcept {
  return (columns + kLanes - 1) / kLanes * kLanes;
}

[[nodiscard]] inline Lanes load_lanes(const double* x) noexcept {
  Lanes lanes;
  std::memcpy(&lanes, x, sizeof lanes);
  return lanes;
}
inline void store_lanes(const Lanes& lanes, double* x) noexcept {
  std::memcpy(x, &lanes, sizeof lanes);
}

template <std::size_t N>
using LanesRow = std::array<Lanes, N>;

// f(n) with the number of lanes of such rows as a std::integral_constant.
template <typename F>
[[gnu::always_inline]] inline auto with_lanes(int columns, const F& f) noexcept {
  static_assert(kMaxBlock <= 3 * kLanes);
  if (columns <= kLanes) return f(std::integral_constant<std::size_t, 1>{});
  if (columns <= 2 * kLanes) return f(std::integral_constant<std::size_t, 2>{});
  return f(std::integral_constant<std::size_t, 3>{});
}

// Sum over k of x[k step] times row k of a, with N lanes a row.
template <std::size_t N>
[[nodiscard, gnu::always_inline]] inline LanesRow<N> combine_rows(const double* x, int step, const double* a,
                                                                  int rows) noexcept {
  LanesRow<N> sum{};
  for (int k = 0; k < rows; ++k) {
    const double factor = x[k * step];
    for (std::size_t i = 0; i < N; ++i) sum[i] += factor * load_lanes(a + i * kLanes);
    a += N * kLanes;
  }
  return sum;
}

// y -= x a, without the lanes behind the last column.
inline void subtract_rows(const double* x, const double* a, int rows, int columns, double* y) noexcept {
  with_lanes(columns, [&](auto n) {
    const LanesRow<n> sum = combine_rows<n>(x, 1, a, rows);
    for (std::size_t i = 0; i + 1 < n; ++i, y += kLanes) store_lanes(load_lanes(y) - sum[i], y);
    const int left = columns - static_cast<int>(n - 1) * kLanes;
    if (left == kLanes) return store_lanes(load_lanes(y) - sum[n - 1], y);
    for (int c = 0; c < left; ++c) y[c] -= sum[n - 1][c];
  });
}

}  // namespace slew::math
