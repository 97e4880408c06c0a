// Solution of a consistent system with a symmetric positive semidefinite matrix, row by row without exchanges.
//
//   A x = b,   A = L D L^T over the rows that are independent of those before them                    (1)
// A row whose pivot is below `tolerance` times its scale depends on the rows before it: it is redundant, its unknown
// becomes zero, and the others solve all equations when b is consistent. So it is always the later row that is named,
// and the same one wherever it runs. A row's scale is its diagonal element, or a reference where that is larger.
// Nothing here allocates after the constructor.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace slew::math {

class Semidefinite {
 public:
  Semidefinite() = default;
  explicit Semidefinite(int size);

  [[nodiscard]] int size() const noexcept { return static_cast<int>(pivot_.size()); }
  // a: row-major, size x size; its lower triangle is read. reference: by row, or empty.
  void factorize(std::span<const double> a, std::span<const double> reference, double tolerance) noexcept;
  [[nodiscard]] bool is_redundant(int row) const noexcept { return is_redundant_[static_cast<std::size_t>(row)] != 0; }
  [[nodiscard]] int rank() const noexcept { return rank_; }
  // Of all rows, redundant ones too: pivot over scale, at most 1. Small near a singular matrix.
  [[nodiscard]] double smallest_pivot() const noexcept { return smallest_pivot_; }

  // b in place.
  void solve(std::span<double> b) const noexcept;

 private:
  std::vector<double> lower_;  // L below its diagonal, row-major
  std::vector<double> pivot_;  // 1 / D
  std::vector<std::uint8_t> is_redundant_;
  int rank_ = 0;
  double smallest_pivot_ = 1;
};

}  // namespace slew::math
