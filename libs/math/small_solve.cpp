// SPDX-License-Identifier: Apache-2.0
#include "math/small_solve.h"

#include <cmath>
#include <type_traits>
#include <utility>

#include "math/fixed_size.h"

namespace slew::math {
namespace {

void swap_rows(double* A, double* B, std::size_t n, std::size_t columns, std::size_t i, std::size_t k) noexcept {
  for (std::size_t j = 0; j < n; ++j) std::swap(A[i * n + j], A[k * n + j]);
  for (std::size_t j = 0; j < columns; ++j) std::swap(B[i * columns + j], B[k * columns + j]);
}

template <typename Size, typename Columns>
bool solve(double* A, double* B, Size n, Columns columns) noexcept {
  for (std::size_t k = 0; k < n; ++k) {
    // largest pivot of the column
    std::size_t pivot = k;
    for (std::size_t i = k + 1; i < n; ++i) {
      if (std::fabs(A[i * n + k]) > std::fabs(A[pivot * n + k])) pivot = i;
    }
    if (pivot != k) swap_rows(A, B, n, columns, k, pivot);
    if (A[k * n + k] == 0 || !std::isfinite(A[k * n + k])) return false;
    const double inverse = 1 / A[k * n + k];
    A[k * n + k] = inverse;
    for (std::size_t i = k + 1; i < n; ++i) {
      const double factor = A[i * n + k] * inverse;
      if (factor == 0) continue;
      for (std::size_t j = k + 1; j < n; ++j) A[i * n + j] -= factor * A[k * n + j];
      for (std::size_t j = 0; j < columns; ++j) B[i * columns + j] -= factor * B[k * columns + j];
    }
  }
  for (std::size_t k = n; k-- > 0;) {
    for (std::size_t column = 0; column < columns; ++column) {
      double sum = B[k * columns + column];
      for (std::size_t j = k + 1; j < n; ++j) sum -= A[k * n + j] * B[j * columns + column];
      B[k * columns + column] = sum * A[k * n + k];
    }
  }
  return true;
}

constexpr std::size_t kMostFixed = 6;  // rows of a crane with all its limits

}  // namespace

bool solve_in_place(double* A, double* B, std::size_t n, std::size_t columns) noexcept {
  if (columns != 1) return solve(A, B, n, columns);
  return with_fixed_size<kMostFixed>(
      n, [&](auto size) { return solve(A, B, size, std::integral_constant<std::size_t, 1>{}); });
}

}  // namespace slew::math
