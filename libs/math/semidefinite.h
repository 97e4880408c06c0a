// SPDX-License-Identifier: Apache-2.0
// Solution of a consistent system with a symmetric positive semidefinite matrix, row by row without exchanges.
//
//   A x = b,   A = L D L^T over the rows that are independent of those before them                    (1)
// A row whose pivot is below `tolerance` times its scale depends on the rows before it: it is redundant, its unknown
// becomes zero, and the others solve all equations when b is consistent. So the later row is always named, and the same
// one on every machine. A row's scale is its diagonal element, or a reference where that is larger.
//
// For a sparse A only the structural non-zeros are given; L holds these and the fill: (k, j) where a path of couplings
// leads from j to k over rows before j. The order stays that of the rows, so every result has the bits of the dense
// factorisation. Uncoupled rows add no cost to each other. Nothing here allocates after the constructor.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace slew::math {

class Semidefinite {
 public:
  Semidefinite() = default;
  // Dense: entry (k, j) of A and L is at k size + j.
  explicit Semidefinite(int size);
  // coupled: for every row the rows before it with which A has an entry, in any order.
  explicit Semidefinite(const std::vector<std::vector<int>>& coupled);

  [[nodiscard]] int size() const noexcept { return static_cast<int>(pivot_.size()); }
  // Size of the vector that factorize() takes, and the place of (row, column <= row) in it; -1: zero by structure.
  [[nodiscard]] int entry_count() const noexcept { return static_cast<int>(lower_.size()); }
  [[nodiscard]] int entry(int row, int column) const noexcept;

  // a: A by entry(), of which the lower triangle is read. reference: by row, or empty.
  void factorize(std::span<const double> a, std::span<const double> reference, double tolerance) noexcept;
  [[nodiscard]] bool is_redundant(int row) const noexcept { return is_redundant_[static_cast<std::size_t>(row)] != 0; }
  [[nodiscard]] int rank() const noexcept { return rank_; }
  // Smallest ratio of pivot to scale over all rows, redundant ones included, at most 1. Small near a singular matrix.
  [[nodiscard]] double smallest_pivot() const noexcept { return smallest_pivot_; }

  // Replaces b by the solution.
  void solve(std::span<double> b) const noexcept;
  // The same for some rows alone, ascending, that are not coupled to the others.
  void solve(std::span<const int> rows, std::span<double> b) const noexcept;

 private:
  // Columns [begin, end) of a row before its diagonal: entry (row, j) is at offset + j.
  struct Run {
    std::size_t begin = 0, end = 0, offset = 0;
  };
  struct Row {
    std::size_t run = 0, run_end = 0;  // indices into runs_
    std::size_t diagonal = 0;          // entry of the diagonal
  };
  // Columns of the rows; the dense case has loops of its own without the cost of the sparse ones.
  enum class Columns { all, some };
  template <Columns kColumns, typename Visit>
  void for_each_run(std::size_t row, Visit&& visit) const noexcept {
    const Row& own = rows_[row];
    if constexpr (kColumns == Columns::all) {
      visit(Run{0, row, own.diagonal - row});
    } else {
      for (std::size_t i = own.run; i < own.run_end; ++i) visit(runs_[i]);
    }
  }
  template <Columns kColumns>
  [[nodiscard]] double eliminate(std::size_t k, std::span<const double> a) noexcept;
  template <Columns kColumns>
  void factorize_rows(std::span<const double> a, std::span<const double> reference, double tolerance) noexcept;
  template <Columns kColumns, typename RowAt>
  void solve_rows(std::size_t count, const RowAt& row_at, std::span<double> b) const noexcept;

  Columns columns_ = Columns::all;
  std::vector<Row> rows_;
  std::vector<Run> runs_;      // runs of columns, row by row
  std::vector<double> lower_;  // L below its diagonal, by entry()
  std::vector<double> pivot_;  // 1 / D
  std::vector<double> row_;    // current row: L D, then zero again
  std::vector<std::uint8_t> is_redundant_;
  int rank_ = 0;
  double smallest_pivot_ = 1;
};

}  // namespace slew::math
