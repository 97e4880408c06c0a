// SPDX-License-Identifier: Apache-2.0
#include "math/stage_matrix.h"

#include <algorithm>

#include "core/check.h"

namespace slew::math {

StageMatrix::StageMatrix(const SparsityPattern& pattern, std::size_t stride)
    : size_(pattern.size()), stride_(stride), lu_(pattern, stride), dense_(size_), mass_(size_, 1) {}

void StageMatrix::set_mass(std::span<const double> mass) noexcept {
  SLEW_CHECK(mass.size() == size_);
  std::copy(mass.begin(), mass.end(), mass_.begin());
  lu_.set_mass(mass);
}

bool StageMatrix::factorise(const double* J, double c) noexcept {
  is_dense_ = !lu_.factorise(J, c);
  if (!is_dense_) return true;
  const std::span<double> a = dense_.matrix();
  for (std::size_t i = 0; i < size_; ++i) {
    for (std::size_t j = 0; j < size_; ++j) a[i * size_ + j] = -J[i * stride_ + j];
    a[i * size_ + i] += c * mass_[i];
  }
  return dense_.factorise();
}

void StageMatrix::solve(std::span<double> b) noexcept {
  if (is_dense_) {
    dense_.solve(b);
  } else {
    lu_.solve(b.data());
  }
}

}  // namespace slew::math
