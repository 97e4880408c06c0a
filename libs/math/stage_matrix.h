// SPDX-License-Identifier: Apache-2.0
// The matrix c M - J of an implicit stage, factorised sparsely with pivots on the diagonal, or densely if one of them
// nearly vanishes. Real-time safe.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "math/dense_lu.h"
#include "math/pattern_lu.h"

namespace slew::math {

class StageMatrix {
 public:
  // J will be handed over row-major with this many columns (>= pattern.size()).
  StageMatrix(const SparsityPattern& pattern, std::size_t stride);

  // Diagonal of M, ones and zeros in the order of J's rows; all ones until this is called. Pre-condition: one for each.
  void set_mass(std::span<const double> mass) noexcept;
  [[nodiscard]] const std::vector<double>& mass() const noexcept { return mass_; }
  // False when the matrix is singular; solve() must not be called then.
  [[nodiscard]] bool factorise(const double* J, double c) noexcept;
  // The last factorisation was a dense one.
  [[nodiscard]] bool is_dense() const noexcept { return is_dense_; }
  // Replaces b by the solution.
  void solve(std::span<double> b) noexcept;

 private:
  std::size_t size_;
  std::size_t stride_;
  PatternLu lu_;
  DenseLu dense_;
  bool is_dense_ = false;
  std::vector<double> mass_;
};

}  // namespace slew::math
