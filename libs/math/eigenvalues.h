// SPDX-License-Identifier: Apache-2.0
// Eigenvalues of a dense real matrix. For checks at load: allocates.
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

namespace slew::math {

// A: n x n, row by row, finite, in any unit; its eigenvalues in the same, in no order. Source: Golub and Van Loan 2013,
// section 7.5 (Francis' QR steps of Eigen).
[[nodiscard]] std::vector<std::complex<double>> eigenvalues(std::span<const double> A, std::size_t n);

}  // namespace slew::math
