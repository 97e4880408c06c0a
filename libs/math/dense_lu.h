// SPDX-License-Identifier: Apache-2.0
// Solution of a small dense system A x = b by LU with partial pivoting, in a fixed order of operations.
//
// No allocation after construction; the result depends on the values only, never on where they lie in memory.
// Cost about 2/3 n^3 + 2 n^2 operations; meant for n up to about 60.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace slew::math {

class DenseLu {
 public:
  explicit DenseLu(std::size_t size);

  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  // Row-major size x size; fill it, then factorise.
  [[nodiscard]] std::span<double> matrix() noexcept { return {a_.data(), a_.size()}; }
  // False when a pivot is zero or not finite; solve() must not be called then.
  [[nodiscard]] bool factorise() noexcept;
  // Replaces b by the solution. Pre-condition: factorise() returned true, b has size() values.
  void solve(std::span<double> b) const noexcept;

 private:
  void swap_rows(std::size_t i, std::size_t k) noexcept;

  std::size_t size_;
  std::vector<double> a_;  // matrix, then its factors
  std::vector<double> inverse_pivot_;
  std::vector<std::size_t> pivot_row_;  // row exchanged with row k in step k
};

}  // namespace slew::math
