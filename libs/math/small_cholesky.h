// SPDX-License-Identifier: Apache-2.0
// Cholesky's factorisation of small symmetric positive definite matrices, and substitutions with the factor: A = C C^T.
// Row-major, the factor in the lower triangle; nothing above the diagonal is read. Backward stable: the relative error
// is the ratio of the eigenvalues times the rounding; an explicit inverse has the square of the ratio.
#pragma once

#include <cmath>

namespace slew::math {

// Factorises in place. False if a pivot is not positive; the rest is then undefined.
[[nodiscard]] inline bool factorize_cholesky(double* a, int size) noexcept {
  for (int c = 0; c < size; ++c) {
    double pivot = a[c * size + c];
    for (int k = 0; k < c; ++k) pivot -= a[c * size + k] * a[c * size + k];
    if (!(pivot > 0)) return false;
    const double root = std::sqrt(pivot);
    a[c * size + c] = root;
    for (int r = c + 1; r < size; ++r) {
      double sum = a[r * size + c];
      for (int k = 0; k < c; ++k) sum -= a[r * size + k] * a[c * size + k];
      a[r * size + c] = sum / root;
    }
  }
  return true;
}

// x := C^-1 x
inline void substitute_forward(const double* C, int size, double* x) noexcept {
  for (int r = 0; r < size; ++r) {
    double sum = x[r];
    for (int k = 0; k < r; ++k) sum -= C[r * size + k] * x[k];
    x[r] = sum / C[r * size + r];
  }
}

// x := C^-T x
inline void substitute_backward(const double* C, int size, double* x) noexcept {
  for (int r = size; r-- > 0;) {
    double sum = x[r];
    for (int k = r + 1; k < size; ++k) sum -= C[k * size + r] * x[k];
    x[r] = sum / C[r * size + r];
  }
}

}  // namespace slew::math
