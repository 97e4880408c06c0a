// SPDX-License-Identifier: Apache-2.0
// Solution of a very small dense system with several right-hand sides, in place and in a fixed order of operations.
#pragma once

#include <cstddef>

namespace slew::math {

// A X = B; A n x n and B n x columns, both row-major; A is overwritten, B becomes X. Gaussian elimination with row
// pivoting. False when a pivot is zero or not finite; B is then unusable. No allocation.
[[nodiscard]] bool solve_in_place(double* A, double* B, std::size_t n, std::size_t columns) noexcept;

}  // namespace slew::math
