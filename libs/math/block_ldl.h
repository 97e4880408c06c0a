// SPDX-License-Identifier: Apache-2.0
// Factorisation of a symmetric saddle-point matrix of small blocks, with a plan that is made once.
//
//   K = [ M  G^T ]     M positive definite on the null space of G, block-sparse
//       [ G   0  ]     G the rows of constraints                                                    (1)
//
// A `regular` node holds unknowns whose own block is regular: a body, or a body with the rows of the joint that hangs
// it on another one. A `definite` node holds unknowns whose own block stays positive definite after the elimination of
// earlier nodes: all nodes of a matrix that is positive definite as a whole. It is factorised by Cholesky, so that
// stiff and soft unknowns may stand in one block. A `closing` node holds rows that close a loop. Nodes are eliminated
// one after the other, K = L D L^T with D block-diagonal. The next node is the eligible node with the fewest
// neighbours; a closing node follows all nodes that it closes and those of `follows`: all unknowns by whose motion its
// rows can be met, since rows that the nodes before it do not move seem redundant. So the cost of a tree grows linearly
// with its size, and a loop adds the fill along itself. (A body and its joint go together, not one after the other as
// in Baraff 1996: -G M^-1 G^T alone would square the condition of M.)
//
// Rows of a closing node that depend on rows eliminated before are found by the pivots of its block and left out: their
// unknowns become zero, the others solve the rest exactly when the right-hand side is consistent. is_redundant() names
// them. The plan depends on the pattern alone, the order of all sums on the plan: results are bit-equal on every
// machine. Nothing here allocates after the constructor.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace slew::math {

inline constexpr int kMaxBlock = 12;

enum class BlockKind : std::uint8_t { regular, definite, closing };

struct BlockNode {
  int size = 0;  // 1 .. kMaxBlock
  BlockKind kind = BlockKind::regular;
};

struct BlockPattern {
  std::vector<BlockNode> nodes;
  std::vector<std::pair<int, int>> couplings;  // pairs of different nodes, each once
  std::vector<std::pair<int, int>> follows{};  // closing node, node before it: beside those that it is coupled to
};

class BlockLdl {
 public:
  explicit BlockLdl(const BlockPattern& pattern);

  [[nodiscard]] int rows() const noexcept { return first_row_.back(); }
  // First row of a node in the vectors of solve().
  [[nodiscard]] int first_row(int node) const noexcept { return first_row_[at(node)]; }

  // ---- filling in, before factorize(); clear() first
  void clear() noexcept;
  // Adds to the block of the matrix at (node, node): symmetric, row-major, size x size.
  void add_diagonal(int node, std::span<const double> block) noexcept;
  // Adds to the block at (row node, column node) of a coupling: row-major, size of row x size of column.
  void add_coupling(int row, int column, std::span<const double> block) noexcept;

  // Lower bound of the scale that a closing row's pivot is compared with, beside the sum of its terms; for rows that
  // may vanish.
  void set_reference(int node, int row, double reference) noexcept {
    reference_[at(first_row_[at(node)] + row)] = reference;
  }

  // A closing row is redundant if its pivot is below `tolerance` times its scale. False when a regular node is singular
  // to working precision, or a definite one is not definite.
  [[nodiscard]] bool factorize(double tolerance) noexcept;
  [[nodiscard]] bool is_redundant(int node, int row) const noexcept {
    return is_redundant_[at(first_row_[at(node)] + row)] != 0;
  }
  // Smallest ratio of pivot to scale over all closing rows, at most 1. Small near a singular matrix.
  [[nodiscard]] double smallest_pivot() const noexcept { return smallest_pivot_; }
  // Restores the value of an earlier factorisation, for callers that depend on the last one.
  void set_smallest_pivot(double pivot) noexcept { smallest_pivot_ = pivot; }
  [[nodiscard]] int redundant_rows() const noexcept { return redundant_rows_; }
  // Root of the determinant of a definite node's remaining block at its elimination.
  [[nodiscard]] double root_of_determinant(int node) const noexcept;

  // K x = b in place; b by first_row().
  void solve(std::span<double> b) const noexcept;

  // Number of blocks below the diagonal of L, fill included: a measure of the cost of a solution.
  [[nodiscard]] int coupling_count() const noexcept { return static_cast<int>(below_.size()); }

 private:
  static std::size_t at(int index) noexcept { return static_cast<std::size_t>(index); }
  struct Below {         // L_row,column
    int row = 0;         // node, eliminated later
    int column = 0;      // node
    int value = 0;       // first entry in values_: size of row x size of column
    int transposed = 0;  // in transposed_
  };
  struct Update {  // A_target -= L_a A_b^T
    int target = 0;
    int a = 0, b = 0;  // entries of below_
    bool is_diagonal = false;
  };
  void plan(const BlockPattern& pattern);
  void list_updates();
  [[nodiscard]] int find(int row, int column) const noexcept;
  [[nodiscard]] bool factorize_definite(int node) noexcept;
  void scale_column(std::size_t k) noexcept;
  void update(const Update& update, int size, int first_transposed) noexcept;

  std::vector<BlockNode> nodes_;
  std::vector<int> first_row_;
  std::vector<int> order_;        // nodes as they are eliminated
  std::vector<int> rank_;         // place in that order, by node
  std::vector<Below> below_;      // by column in the order of elimination, then by row in it
  std::vector<int> first_below_;  // by place in the order
  std::vector<Update> updates_;   // by column
  std::vector<int> first_update_;
  std::vector<int> first_value_;    // first value of the diagonal blocks, by node
  std::vector<double> values_;      // A, then L below the diagonal; below a definite node L times its factor
  std::vector<double> transposed_;  // the blocks below the diagonal, transposed
  std::vector<double> inverse_;     // inverses of the diagonal blocks, by first_value_; definite nodes: Cholesky's
                                    // factor
  std::vector<double> scaled_;      // L of the current column, transposed
  std::vector<double> reference_;   // lower bound of each closing row's scale
  std::vector<double> scale_;       // scale of each closing row's pivot, reference included
  double smallest_pivot_ = 1;
  std::vector<std::uint8_t> is_redundant_;
  int redundant_rows_ = 0;
};

}  // namespace slew::math
