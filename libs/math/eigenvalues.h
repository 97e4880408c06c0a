// SPDX-License-Identifier: Apache-2.0
// Eigenvalues and eigenvectors of a dense real matrix. For checks at load: allocates.
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

namespace slew::math {

// A: n x n, row by row, finite, in any unit; its eigenvalues in the same, in no order. Source: Golub and Van Loan 2013,
// section 7.5 (Francis' QR steps of Eigen).
[[nodiscard]] std::vector<std::complex<double>> eigenvalues(std::span<const double> A, std::size_t n);

struct Eigenpairs {
  std::vector<std::complex<double>> values;   // n, in no order
  std::vector<std::complex<double>> vectors;  // n x n, column by column, of length 1
};

// The same with the right eigenvectors; empty when the QR steps do not converge.
[[nodiscard]] Eigenpairs eigenpairs(std::span<const double> A, std::size_t n);

}  // namespace slew::math
