// Solution of a consistent system with a symmetric positive semidefinite matrix, row by row without exchanges.
//
//   A x = b,   A = L D L^T over the rows that are independent of those before them                    (1)
// A row whose pivot is below `tolerance` times its scale depends on the rows before it: it is redundant, its unknown
// becomes zero, and the others solve all equations when b is consistent. So it is always the later row that is named,
// and the same one wherever it runs. A row's scale is its diagonal element, or a reference where that is larger.
//
// Of a sparse A only the entries that are not zero by structure are given, and of L those and the fill: (k, j) where a
// path of couplings leads from j to k over rows before j. The order stays that of the rows, so every result has the
// bits of the dense factorisation. Rows that nothing couples cost nothing together. Nothing here allocates after the
// constructor.
#pragma once

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
  // Of the vector that factorize() takes, and the place of (row, column <= row) in it; -1: zero by structure.
  [[nodiscard]] int entry_count() const noexcept { return static_cast<int>(lower_.size()); }
  [[nodiscard]] int entry(int row, int column) const noexcept;

  // a: A by entry(), of which the lower triangle is read. reference: by row, or empty.
  void factorize(std::span<const double> a, std::span<const double> reference, double tolerance) noexcept;
  [[nodiscard]] bool is_redundant(int row) const noexcept { return is_redundant_[static_cast<std::size_t>(row)] != 0; }
  [[nodiscard]] int rank() const noexcept { return rank_; }
  // Of all rows, redundant ones too: pivot over scale, at most 1. Small near a singular matrix.
  [[nodiscard]] double smallest_pivot() const noexcept { return smallest_pivot_; }

  // b in place.
  void solve(std::span<double> b) const noexcept;
  // The same for some rows alone, ascending, that nothing couples to the others.
  void solve(std::span<const int> rows, std::span<double> b) const noexcept;

 private:
  // Columns [begin, end) of a row before its diagonal; entry (row, begin) is at value, the others follow.
  struct Run {
    int begin = 0, end = 0;
    int value = 0;
  };
  // The first run of a row, nearly always the only one, and where the others are.
  struct Row {
    Run first{};
    int more = 0, more_end = 0;  // of runs_
    int diagonal = 0;            // its entry
  };
  template <typename Visit>
  void for_each_run(const Row& row, Visit&& visit) const noexcept {
    visit(row.first);
    for (int i = row.more; i < row.more_end; ++i) visit(runs_[static_cast<std::size_t>(i)]);
  }
  void add_row(const std::vector<int>& columns, int& entries);
  [[nodiscard]] double eliminate(std::size_t k, std::span<const double> a) noexcept;
  [[nodiscard]] double eliminate_dense(std::size_t k, std::span<const double> a) noexcept;
  void solve_dense(std::span<double> b) const noexcept;
  void forward(std::size_t row, std::span<double> b) const noexcept;
  void backward(std::size_t row, std::span<double> b) const noexcept;

  std::vector<Row> rows_;
  std::vector<Run> runs_;
  bool is_dense_ = true;       // two loops are: they do not pay for what many leave out
  std::vector<double> lower_;  // L below its diagonal, by entry()
  std::vector<double> pivot_;  // 1 / D
  std::vector<double> row_;    // of the row under way: L D, then zero again
  std::vector<std::uint8_t> is_redundant_;
  int rank_ = 0;
  double smallest_pivot_ = 1;
};

}  // namespace slew::math
