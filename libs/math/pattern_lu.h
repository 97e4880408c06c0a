// SPDX-License-Identifier: Apache-2.0
// LU of (c M - J), M diagonal, for a J whose non-zero pattern is known at build: pivots on the diagonal in an order
// chosen once.
//
// The order is the greedy Markowitz order (fewest operations next, the lowest index of equals); the elimination becomes
// flat lists of slots, so a factorisation is a few hundred multiply-adds without index search. Factors are stored
// column by column: a solution subtracts each computed unknown from the rows that need it, which do not depend on one
// another. Diagonal pivots are safe for the matrices of stiff integrators as long as they stay near or above c;
// factorise() reports a pivot that does not, and the caller then pivots densely (DenseLu).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace slew::math {

// Which entries of a square matrix may be non-zero; the diagonal always may.
class SparsityPattern {
 public:
  explicit SparsityPattern(std::size_t size) : size_(size), entry_(size * size, 0) {
    for (std::size_t i = 0; i < size; ++i) add(i, i);
  }
  void add(std::size_t row, std::size_t column) { entry_[row * size_ + column] = 1; }
  [[nodiscard]] bool has(std::size_t row, std::size_t column) const { return entry_[row * size_ + column] != 0; }
  [[nodiscard]] std::size_t size() const { return size_; }

 private:
  std::size_t size_;
  std::vector<char> entry_;
};

class PatternLu {
 public:
  // limit of the unknowns: a Slot can count their entries for any pattern
  static constexpr std::size_t kMostUnknowns = 200;

  // J will be handed over row-major with this many columns (>= pattern.size()).
  PatternLu(const SparsityPattern& pattern, std::size_t stride);

  // Diagonal of M, ones and zeros in the order of J's rows; all ones until this is called.
  void set_mass(std::span<const double> mass) noexcept;
  // Factorises c M - J. False when a pivot falls below 1e-3 c in size or is not finite.
  [[nodiscard]] bool factorise(const double* J, double c) noexcept;
  // Replaces b by the solution.
  void solve(double* b) noexcept;

 private:
  using Slot = std::uint16_t;
  struct Gather {
    std::uint32_t source;  // in J
    Slot slot;
  };
  struct Elimination {  // elimination of one entry (i, k) of L
    Slot entry;
    Slot updates;  // how many of update_ follow
  };
  struct Update {
    Slot target, source;
  };
  // A row of a factor with entries beside the diagonal.
  struct Row {
    Slot pivot;
    Slot entries;
  };

  void choose_order(const SparsityPattern& pattern);
  void number_slots(const std::vector<char>& filled);
  void list_operations(const std::vector<char>& filled);
  void substitute(const std::vector<Row>& rows, const Slot* column, const double* entry) noexcept;

  std::size_t size_;
  std::size_t stride_;
  std::vector<std::size_t> order_;  // order_[k]: index eliminated k-th
  std::vector<Slot> slot_;          // slot of entry (i, k) in elimination order, while the lists are built
  std::vector<Gather> gather_;
  std::vector<Slot> fill_;          // slots that only the elimination fills
  std::vector<Slot> eliminations_;  // how many of elimination_ belong to pivot k
  std::vector<Elimination> elimination_;
  std::vector<Update> update_;
  std::vector<Row> lower_row_, upper_row_;         // ascending; descending
  std::vector<Slot> lower_column_, upper_column_;  // column of each entry, row by row
  std::vector<double> mass_;                       // by pivot
  std::vector<double> value_;                      // diagonal | L by rows ascending | U by rows descending
  std::vector<double> inverse_pivot_;
  std::vector<double> work_;
};

}  // namespace slew::math
