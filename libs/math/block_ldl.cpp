// SPDX-License-Identifier: Apache-2.0
#include "math/block_ldl.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "core/check.h"
#include "math/small_cholesky.h"

namespace slew::math {
namespace {

std::size_t index(int i) noexcept {
  return static_cast<std::size_t>(i);
}

using Neighbours = std::vector<std::set<int>>;

Neighbours neighbours_of(const BlockPattern& pattern) {
  Neighbours neighbours(pattern.nodes.size());
  for (const auto& [a, b] : pattern.couplings) {
    SLEW_CHECK(a != b);
    neighbours[static_cast<std::size_t>(a)].insert(b);
    neighbours[static_cast<std::size_t>(b)].insert(a);
  }
  return neighbours;
}

// y -= a x, a of rows x columns
void subtract_product(const double* a, int rows, int columns, const double* x, double* y) noexcept {
  for (int r = 0; r < rows; ++r) {
    double sum = 0;
    for (int c = 0; c < columns; ++c) sum += a[r * columns + c] * x[c];
    y[r] -= sum;
  }
}

// y -= a^T x
void subtract_transposed_product(const double* a, int rows, int columns, const double* x, double* y) noexcept {
  for (int c = 0; c < columns; ++c) {
    double sum = 0;
    for (int r = 0; r < rows; ++r) sum += a[r * columns + c] * x[r];
    y[c] -= sum;
  }
}

// c = a b, a of rows x inner, b of inner x inner
void multiply(const double* a, const double* b, int rows, int inner, double* c) noexcept {
  for (int r = 0; r < rows; ++r) {
    for (int k = 0; k < inner; ++k) {
      double sum = 0;
      for (int i = 0; i < inner; ++i) sum += a[r * inner + i] * b[i * inner + k];
      c[r * inner + k] = sum;
    }
  }
}

using Block = std::array<double, static_cast<std::size_t>(kMaxBlock) * kMaxBlock>;

// a := S a S with powers of two, so that the largest entry of every row is near one; two rounds are enough
void equilibrate(Block& a, int size, std::array<double, kMaxBlock>& scale) noexcept {
  std::fill_n(scale.begin(), size, 1.0);
  for (int round = 0; round < 2; ++round) {
    std::array<double, kMaxBlock> factor{};
    for (int r = 0; r < size; ++r) {
      double largest = 0;
      for (int c = 0; c < size; ++c) largest = std::max(largest, std::fabs(a[index(r * size + c)]));
      int exponent = 0;
      if (largest > 0 && std::isfinite(largest)) std::frexp(largest, &exponent);
      factor[index(r)] = std::ldexp(1.0, -exponent / 2);
    }
    for (int r = 0; r < size; ++r) {
      scale[index(r)] *= factor[index(r)];
      for (int c = 0; c < size; ++c) a[index(r * size + c)] *= factor[index(r)] * factor[index(c)];
    }
  }
}

// Gauss and Jordan with complete pivoting; false when a pivot is lost in rounding
bool invert_general(Block& a, int size) noexcept {
  constexpr double kLost = 1e-14;
  std::array<int, kMaxBlock> pivot_row{}, pivot_column{};
  std::array<bool, kMaxBlock> is_done{};
  for (int step = 0; step < size; ++step) {
    int row = -1, column = -1;
    double largest = -1;
    for (int r = 0; r < size; ++r) {
      for (int c = 0; c < size && !is_done[index(r)]; ++c) {
        if (is_done[index(c)] || std::fabs(a[index(r * size + c)]) <= largest) continue;
        largest = std::fabs(a[index(r * size + c)]);
        row = r;
        column = c;
      }
    }
    if (!(largest > kLost)) return false;
    // the pivot moves to the diagonal
    for (int c = 0; c < size; ++c) std::swap(a[index(row * size + c)], a[index(column * size + c)]);
    is_done[index(column)] = true;
    pivot_row[index(step)] = row;
    pivot_column[index(step)] = column;
    const double inverse = 1 / a[index(column * size + column)];
    a[index(column * size + column)] = 1;
    for (int c = 0; c < size; ++c) a[index(column * size + c)] *= inverse;
    for (int r = 0; r < size; ++r) {
      if (r == column) continue;
      const double factor = a[index(r * size + column)];
      a[index(r * size + column)] = 0;
      for (int c = 0; c < size; ++c) a[index(r * size + c)] -= factor * a[index(column * size + c)];
    }
  }
  for (int step = size; step-- > 0;) {
    const int row = pivot_row[index(step)], column = pivot_column[index(step)];
    for (int r = 0; r < size; ++r) std::swap(a[index(r * size + row)], a[index(r * size + column)]);
  }
  return true;
}

// One step of Gauss and Jordan on a symmetric matrix; swept over all its rows it is the negative inverse.
void sweep(double* a, int size, int pivot) noexcept {
  const double inverse = 1 / a[pivot * size + pivot];
  for (int r = 0; r < size; ++r) {
    if (r == pivot) continue;
    const double factor = a[r * size + pivot] * inverse;
    for (int c = 0; c < size; ++c) {
      if (c != pivot) a[r * size + c] -= factor * a[pivot * size + c];
    }
  }
  for (int r = 0; r < size; ++r) {
    if (r == pivot) continue;
    a[r * size + pivot] *= inverse;
    a[pivot * size + r] *= inverse;
  }
  a[pivot * size + pivot] = -inverse;
}

}  // namespace

BlockLdl::BlockLdl(const BlockPattern& pattern) : nodes_(pattern.nodes), rank_(pattern.nodes.size()) {
  int row = 0, value = 0;
  for (const BlockNode& node : nodes_) {
    SLEW_CHECK(node.size >= 1 && node.size <= kMaxBlock);
    first_row_.push_back(row);
    first_value_.push_back(value);
    row += node.size;
    value += node.size * node.size;
  }
  first_row_.push_back(row);
  inverse_.resize(at(value));
  plan(pattern);
  for (Below& below : below_) {
    below.value = value;
    value += nodes_[at(below.row)].size * nodes_[at(below.column)].size;
  }
  values_.resize(at(value));
  list_updates();
  scale_.resize(at(row));
  reference_.resize(at(row));
  is_redundant_.resize(at(row));
}

// ---- the plan -------------------------------------------------------------------------------------------------

// fewest neighbours first, then the lowest index; eliminating a node couples its neighbours
void BlockLdl::plan(const BlockPattern& pattern) {
  Neighbours left = neighbours_of(pattern);
  std::vector<bool> is_done(nodes_.size());
  Neighbours before = left;  // by closing node: nodes that it waits for
  for (const auto& [closing, node] : pattern.follows) {
    SLEW_CHECK(nodes_[at(closing)].kind == BlockKind::closing && nodes_[at(node)].kind != BlockKind::closing);
    before[at(closing)].insert(node);
  }
  std::vector<int> unclosed(nodes_.size());  // how many of them are left
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    if (nodes_[i].kind == BlockKind::closing) unclosed[i] = static_cast<int>(before[i].size());
  }
  std::vector<std::vector<int>> columns;
  while (order_.size() < nodes_.size()) {
    int best = -1;
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      if (is_done[i] || unclosed[i] > 0) continue;
      if (best < 0 || left[i].size() < left[at(best)].size()) best = static_cast<int>(i);
    }
    is_done[at(best)] = true;
    rank_[at(best)] = static_cast<int>(order_.size());
    order_.push_back(best);
    const std::vector<int> rest(left[at(best)].begin(), left[at(best)].end());
    columns.push_back(rest);
    for (const int a : rest) {
      left[at(a)].erase(best);
      for (const int b : rest) {
        if (a != b) left[at(a)].insert(b);
      }
    }
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      if (nodes_[i].kind == BlockKind::closing && before[i].contains(best)) --unclosed[i];
    }
  }
  for (std::size_t k = 0; k < columns.size(); ++k) {
    std::sort(columns[k].begin(), columns[k].end(), [&](int a, int b) { return rank_[at(a)] < rank_[at(b)]; });
    first_below_.push_back(static_cast<int>(below_.size()));
    for (const int row : columns[k]) below_.push_back({row, order_[k], 0});
  }
  first_below_.push_back(static_cast<int>(below_.size()));
}

void BlockLdl::list_updates() {
  int largest = 0;
  for (std::size_t k = 0; k < order_.size(); ++k) {
    first_update_.push_back(static_cast<int>(updates_.size()));
    int column_values = 0;
    for (int a = first_below_[k]; a < first_below_[k + 1]; ++a) {
      for (int b = first_below_[k]; b <= a; ++b) {
        const int row = below_[at(a)].row, column = below_[at(b)].row;
        const int target = row == column ? first_value_[at(row)] : below_[at(find(row, column))].value;
        updates_.push_back({target, a, b, row == column});
      }
      column_values += nodes_[at(below_[at(a)].row)].size * nodes_[at(order_[k])].size;
    }
    largest = std::max(largest, column_values);
  }
  first_update_.push_back(static_cast<int>(updates_.size()));
  scaled_.resize(at(largest));
}

// entry of below_ for two coupled nodes, the row eliminated after the column
int BlockLdl::find(int row, int column) const noexcept {
  const std::size_t k = at(rank_[at(column)]);
  for (int i = first_below_[k]; i < first_below_[k + 1]; ++i) {
    if (below_[at(i)].row == row) return i;
  }
  SLEW_CHECK(false);
  return -1;
}

// ---- filling in -----------------------------------------------------------------------------------------------

void BlockLdl::clear() noexcept {
  std::fill(values_.begin(), values_.end(), 0.0);
}

void BlockLdl::add_diagonal(int node, std::span<const double> block) noexcept {
  double* value = values_.data() + first_value_[at(node)];
  for (std::size_t i = 0; i < block.size(); ++i) value[i] += block[i];
}

void BlockLdl::add_coupling(int row, int column, std::span<const double> block) noexcept {
  const bool is_below = rank_[at(row)] > rank_[at(column)];
  const Below& below = below_[at(is_below ? find(row, column) : find(column, row))];
  double* value = values_.data() + below.value;
  const int rows = nodes_[at(row)].size, columns = nodes_[at(column)].size;
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < columns; ++c) value[is_below ? r * columns + c : c * rows + r] += block[at(r * columns + c)];
  }
}

// ---- factorisation --------------------------------------------------------------------------------------------

// The whole inverse, by Gauss and Jordan with complete pivoting on the block scaled to entries of one size.
bool BlockLdl::invert_regular(int node) noexcept {
  const int size = nodes_[at(node)].size;
  Block a{};
  std::copy_n(values_.data() + first_value_[at(node)], size * size, a.begin());
  std::array<double, kMaxBlock> scale{};
  equilibrate(a, size, scale);
  const bool is_whole = invert_general(a, size);
  double* inverse = inverse_.data() + first_value_[at(node)];
  for (int r = 0; r < size; ++r) {
    // symmetric to the bit
    for (int c = 0; c < size; ++c) {
      inverse[r * size + c] = 0.5 * (a[at(r * size + c)] + a[at(c * size + r)]) * scale[at(r)] * scale[at(c)];
    }
  }
  return is_whole;
}

bool BlockLdl::factorize_definite(int node) noexcept {
  const int size = nodes_[at(node)].size;
  double* C = inverse_.data() + first_value_[at(node)];
  std::copy_n(values_.data() + first_value_[at(node)], size * size, C);
  return factorize_cholesky(C, size);
}

double BlockLdl::root_of_determinant(int node) const noexcept {
  const int size = nodes_[at(node)].size;
  double product = 1;
  for (int i = 0; i < size; ++i) product *= inverse_[at(first_value_[at(node)] + i * size + i)];
  return product;
}

// Inverse over the independent rows, zero in the others. Pivots are taken by size relative to the scale of their row.
void BlockLdl::invert_closing(int node, double tolerance) noexcept {
  const int size = nodes_[at(node)].size, row = first_row_[at(node)];
  Block a{};
  std::copy_n(values_.data() + first_value_[at(node)], size * size, a.begin());
  std::array<bool, kMaxBlock> is_swept{};
  for (int step = 0; step < size; ++step) {
    int pivot = -1;
    double largest = tolerance, largest_left = 0;
    for (int r = 0; r < size; ++r) {
      const double value = -a[at(r * size + r)] / scale_[at(row + r)];
      if (!is_swept[at(r)]) largest_left = std::max(largest_left, value);
      if (!is_swept[at(r)] && value > largest) {
        largest = value;
        pivot = r;
      }
    }
    smallest_pivot_ = std::min(smallest_pivot_, largest_left);
    if (pivot < 0) break;
    sweep(a.data(), size, pivot);
    is_swept[at(pivot)] = true;
  }
  double* inverse = inverse_.data() + first_value_[at(node)];
  for (int r = 0; r < size; ++r) {
    is_redundant_[at(row + r)] = is_swept[at(r)] ? 0 : 1;
    for (int c = 0; c < size; ++c) {
      inverse[r * size + c] = is_swept[at(r)] && is_swept[at(c)] ? -a[at(r * size + c)] : 0.0;
    }
  }
}

bool BlockLdl::factorize(double tolerance) noexcept {
  scale_ = reference_;
  smallest_pivot_ = 1;
  bool is_regular = true;
  for (std::size_t k = 0; k < order_.size(); ++k) {
    const int node = order_[k], size = nodes_[at(node)].size;
    const BlockKind kind = nodes_[at(node)].kind;
    if (kind == BlockKind::closing) {
      invert_closing(node, tolerance);
    } else {
      is_regular = (kind == BlockKind::regular ? invert_regular(node) : factorize_definite(node)) && is_regular;
    }
    // L of this column beside its source; below a definite node, C of A = C C^T replaces both
    double* L = scaled_.data();
    for (int i = first_below_[k]; i < first_below_[k + 1]; ++i) {
      const int rows = nodes_[at(below_[at(i)].row)].size;
      double* A = values_.data() + below_[at(i)].value;
      if (kind == BlockKind::definite) {
        for (int r = 0; r < rows; ++r) {
          substitute_forward(inverse_.data() + first_value_[at(node)], size, A + r * size);
        }
        std::copy_n(A, rows * size, L);
      } else {
        multiply(A, inverse_.data() + first_value_[at(node)], rows, size, L);
      }
      L += rows * size;
    }
    const int column_value = first_below_[k] < first_below_[k + 1] ? below_[at(first_below_[k])].value : 0;
    for (int i = first_update_[k]; i < first_update_[k + 1]; ++i) {
      const Update& update = updates_[at(i)];
      const Below& a = below_[at(update.a)];
      const Below& b = below_[at(update.b)];
      const int rows = nodes_[at(a.row)].size, columns = nodes_[at(b.row)].size;
      const double* L_a = scaled_.data() + (a.value - column_value);
      const double* A_b = values_.data() + b.value;
      double* target = values_.data() + update.target;
      for (int r = 0; r < rows; ++r) {
        for (int c = 0; c < columns; ++c) {
          double sum = 0;
          for (int j = 0; j < size; ++j) sum += L_a[r * size + j] * A_b[c * size + j];
          target[r * columns + c] -= sum;
          if (update.is_diagonal && r == c) scale_[at(first_row_[at(a.row)] + r)] += std::fabs(sum);
        }
      }
    }
    const int values = static_cast<int>(L - scaled_.data());
    std::copy_n(scaled_.data(), values, values_.data() + column_value);
  }
  redundant_rows_ = 0;
  for (const std::uint8_t is_redundant : is_redundant_) redundant_rows_ += is_redundant;
  return is_regular;
}

void BlockLdl::solve(std::span<double> b) const noexcept {
  for (std::size_t k = 0; k < order_.size(); ++k) {
    const int node = order_[k], size = nodes_[at(node)].size;
    double* x = b.data() + first_row_[at(node)];
    const bool is_definite = nodes_[at(node)].kind == BlockKind::definite;
    const double* inverse = inverse_.data() + first_value_[at(node)];
    if (is_definite) substitute_forward(inverse, size, x);
    for (int i = first_below_[k]; i < first_below_[k + 1]; ++i) {
      const Below& below = below_[at(i)];
      subtract_product(values_.data() + below.value, nodes_[at(below.row)].size, size, x,
                       b.data() + first_row_[at(below.row)]);
    }
    if (is_definite) continue;
    std::array<double, kMaxBlock> y{};
    for (int r = 0; r < size; ++r) {
      for (int c = 0; c < size; ++c) y[at(r)] += inverse[r * size + c] * x[c];
    }
    std::copy_n(y.begin(), size, x);
  }
  for (std::size_t k = order_.size(); k-- > 0;) {
    const int node = order_[k], size = nodes_[at(node)].size;
    double* x = b.data() + first_row_[at(node)];
    for (int i = first_below_[k]; i < first_below_[k + 1]; ++i) {
      const Below& below = below_[at(i)];
      subtract_transposed_product(values_.data() + below.value, nodes_[at(below.row)].size, size,
                                  b.data() + first_row_[at(below.row)], x);
    }
    if (nodes_[at(node)].kind == BlockKind::definite) {
      substitute_backward(inverse_.data() + first_value_[at(node)], size, x);
    }
  }
}

}  // namespace slew::math
