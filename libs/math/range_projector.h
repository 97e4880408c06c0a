// SPDX-License-Identifier: Apache-2.0
// Range of a symmetric positive semidefinite matrix W, m x m, row-major.
//
//   W = L L^T by Cholesky with complete pivoting, L m x r of full column rank                          (1)
//   P = L (L^T L)^-1 L^T, the orthogonal projector onto the range of W                                 (2)
// A row whose remaining pivot is below kRankTolerance of its diagonal element depends on the others.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace slew::math {

// (1); returns the rank r. L: m x r in m x m elements, row-major with m columns; left: m elements of work space. Does
// not allocate.
[[nodiscard]] std::size_t pivoted_cholesky(std::span<const double> W, std::span<double> L,
                                           std::span<double> left) noexcept;

// (2), m x m, row-major; exactly the identity where W has full rank. Allocates.
[[nodiscard]] std::vector<double> range_projector(std::span<const double> W, std::size_t m);

}  // namespace slew::math
