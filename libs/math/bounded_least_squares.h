// SPDX-License-Identifier: Apache-2.0
// Least squares with lower bounds, for a few unknowns:
//
//   min |M q - b|,   q >= 0;   among these the q nearest to t >= 0                                             (1)
// by the active-set method of Lawson and Hanson 1974 (ch. 23) on |M q - b|^2 + w |q - t|^2. With the unknowns of a set
// free and the others 0, its minimum is q = t + M^T lambda with (M M^T + w) lambda = b - M t. At the set found
// the weight's effect is removed by correcting q for the remainder b - M q. A singular value of M far below sqrt(w)
// counts as zero: what only such a direction could meet remains.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace slew::math {

// M: rows x columns, row-major, with elements of the size of 1; b by row, t by column, t >= 0. Allocates.
[[nodiscard]] std::vector<double> bounded_least_squares(std::span<const double> M, std::span<const double> b,
                                                        std::span<const double> t);

}  // namespace slew::math
