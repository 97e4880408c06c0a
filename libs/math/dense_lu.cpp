// SPDX-License-Identifier: Apache-2.0
#include "math/dense_lu.h"

#include <cmath>
#include <utility>

#include "core/check.h"

namespace slew::math {

DenseLu::DenseLu(std::size_t size) : size_(size), a_(size * size), inverse_pivot_(size), pivot_row_(size) {}

void DenseLu::swap_rows(std::size_t i, std::size_t k) noexcept {
  for (std::size_t j = 0; j < size_; ++j) std::swap(a_[i * size_ + j], a_[k * size_ + j]);
}

bool DenseLu::factorise() noexcept {
  for (std::size_t k = 0; k < size_; ++k) {
    // largest element of the column below; the first if several are equal
    std::size_t pivot = k;
    for (std::size_t i = k + 1; i < size_; ++i) {
      if (std::fabs(a_[i * size_ + k]) > std::fabs(a_[pivot * size_ + k])) pivot = i;
    }
    pivot_row_[k] = pivot;
    if (pivot != k) swap_rows(pivot, k);
    const double* row_k = &a_[k * size_];
    if (!std::isfinite(row_k[k]) || row_k[k] == 0) return false;
    inverse_pivot_[k] = 1 / row_k[k];
    // eliminate
    for (std::size_t i = k + 1; i < size_; ++i) {
      double* row_i = &a_[i * size_];
      if (row_i[k] == 0) continue;
      const double factor = row_i[k] * inverse_pivot_[k];
      row_i[k] = factor;
      for (std::size_t j = k + 1; j < size_; ++j) row_i[j] -= factor * row_k[j];
    }
  }
  return true;
}

void DenseLu::solve(std::span<double> b) const noexcept {
  SLEW_ASSERT(b.size() == size_);
  for (std::size_t k = 0; k < size_; ++k) {
    if (pivot_row_[k] != k) std::swap(b[k], b[pivot_row_[k]]);
  }
  for (std::size_t i = 1; i < size_; ++i) {
    double sum = b[i];
    for (std::size_t j = 0; j < i; ++j) sum -= a_[i * size_ + j] * b[j];
    b[i] = sum;
  }
  for (std::size_t i = size_; i-- > 0;) {
    double sum = b[i];
    for (std::size_t j = i + 1; j < size_; ++j) sum -= a_[i * size_ + j] * b[j];
    b[i] = sum * inverse_pivot_[i];
  }
}

}  // namespace slew::math
