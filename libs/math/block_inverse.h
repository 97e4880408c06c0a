// SPDX-License-Identifier: Apache-2.0
// Inverses of the diagonal blocks of block_ldl.h, stored as in block_lanes.h. Internal to the library.
#pragma once

#include <cstdint>

namespace slew::math {

// Inverse of a symmetric block of any signature, by Gauss and Jordan with complete pivoting on the block scaled to
// entries of one size; symmetric to the bit. False if a pivot is lost in rounding.
[[nodiscard]] bool invert_block(const double* block, int size, double* inverse) noexcept;

// Inverse of a negative semi-definite block over its independent rows, zero in the others, transposed. Pivots are taken
// by size relative to the scale of their row, down to the tolerance. Returns the least of the ratios that were largest
// among the rows left, at most 1.
double invert_independent(const double* block, int size, const double* scale, double tolerance, double* transposed,
                          std::uint8_t* is_dependent) noexcept;

}  // namespace slew::math
