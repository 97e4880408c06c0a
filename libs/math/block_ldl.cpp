// SPDX-License-Identifier: Apache-2.0
#include "math/block_ldl.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "core/check.h"
#include "math/block_inverse.h"
#include "math/block_lanes.h"
#include "math/small_cholesky.h"

namespace slew::math {
namespace {

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

// a of rows x columns into its transpose
void transpose_block(const double* a, int rows, int columns, double* transposed) noexcept {
  const int from = stride_of(columns), to = stride_of(rows);
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < columns; ++c) transposed[c * to + r] = a[r * from + c];
  }
}

// L^T = D^-1 A^T, all with rows of N lanes
template <std::size_t N>
[[gnu::always_inline]] inline void scale_rows(const double* inverse, int size, const double* A_t,
                                              double* L_t) noexcept {
  for (int k = 0; k < size; ++k) {
    const LanesRow<N> row = combine_rows<N>(inverse + k * stride_of(size), 1, A_t, size);
    for (std::size_t i = 0; i < N; ++i) store_lanes(row[i], L_t + (static_cast<std::size_t>(k) * N + i) * kLanes);
  }
}

// C^-1 A^T in place, rows of N lanes
template <std::size_t N>
[[gnu::always_inline]] inline void substitute_rows(const double* C, int size, double* A_t) noexcept {
  const auto row = [&](int r, std::size_t i) { return A_t + (static_cast<std::size_t>(r) * N + i) * kLanes; };
  for (int r = 0; r < size; ++r) {
    for (std::size_t i = 0; i < N; ++i) {
      Lanes sum = load_lanes(row(r, i));
      for (int k = 0; k < r; ++k) sum -= C[r * size + k] * load_lanes(row(k, i));
      store_lanes(sum / C[r * size + r], row(r, i));
    }
  }
}

}  // namespace

BlockLdl::BlockLdl(const BlockPattern& pattern) : nodes_(pattern.nodes), rank_(pattern.nodes.size()) {
  int row = 0, value = 0;
  for (const BlockNode& node : nodes_) {
    SLEW_CHECK(node.size >= 1 && node.size <= kMaxBlock);
    first_row_.push_back(row);
    first_value_.push_back(value);
    row += node.size;
    value += node.size * stride_of(node.size);
  }
  first_row_.push_back(row);
  inverse_.resize(at(value));
  plan(pattern);
  int transposed = 0;
  for (Below& below : below_) {
    const int rows = nodes_[at(below.row)].size, columns = nodes_[at(below.column)].size;
    below.value = value;
    below.transposed = transposed;
    value += rows * stride_of(columns);
    transposed += columns * stride_of(rows);
  }
  values_.resize(at(value));
  transposed_.resize(at(transposed));
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
      column_values += stride_of(nodes_[at(below_[at(a)].row)].size) * nodes_[at(order_[k])].size;
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
  const int size = nodes_[at(node)].size, stride = stride_of(size);
  double* value = values_.data() + first_value_[at(node)];
  for (int r = 0; r < size; ++r) {
    for (int c = 0; c < size; ++c) value[r * stride + c] += block[at(r * size + c)];
  }
}

void BlockLdl::add_coupling(int row, int column, std::span<const double> block) noexcept {
  const bool is_below = rank_[at(row)] > rank_[at(column)];
  const Below& below = below_[at(is_below ? find(row, column) : find(column, row))];
  double* value = values_.data() + below.value;
  const int rows = nodes_[at(row)].size, columns = nodes_[at(column)].size;
  const int stride = stride_of(is_below ? columns : rows);
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < columns; ++c) value[is_below ? r * stride + c : c * stride + r] += block[at(r * columns + c)];
  }
}

// ---- factorisation --------------------------------------------------------------------------------------------

bool BlockLdl::factorize_definite(int node) noexcept {
  const int size = nodes_[at(node)].size;
  const double* A = values_.data() + first_value_[at(node)];
  double* C = inverse_.data() + first_value_[at(node)];
  for (int r = 0; r < size; ++r) std::copy_n(A + r * stride_of(size), size, C + r * size);
  return factorize_cholesky(C, size);
}

double BlockLdl::root_of_determinant(int node) const noexcept {
  const int size = nodes_[at(node)].size;
  double product = 1;
  for (int i = 0; i < size; ++i) product *= inverse_[at(first_value_[at(node)] + i * size + i)];
  return product;
}

// L^T of the column at this place in the order, into scaled_ and, with A^T, into transposed_; below a definite node, C
// of A = C C^T replaces both.
void BlockLdl::scale_column(std::size_t k) noexcept {
  const int node = order_[k], size = nodes_[at(node)].size;
  const bool is_definite = nodes_[at(node)].kind == BlockKind::definite;
  const double* inverse = inverse_.data() + first_value_[at(node)];
  double* L_t = scaled_.data();
  for (int i = first_below_[k]; i < first_below_[k + 1]; ++i) {
    const Below& below = below_[at(i)];
    const int rows = nodes_[at(below.row)].size;
    double* A_t = transposed_.data() + below.transposed;
    transpose_block(values_.data() + below.value, rows, size, A_t);
    with_lanes(rows, [&](auto n) {
      if (is_definite) {
        substitute_rows<n>(inverse, size, A_t);
        std::copy_n(A_t, at(size) * n * kLanes, L_t);
      } else {
        scale_rows<n>(inverse, size, A_t, L_t);
      }
    });
    L_t += size * stride_of(rows);
  }
}

// A_target -= L_a A_b^T
void BlockLdl::update(const Update& update, int size, int first_transposed) noexcept {
  const Below& a = below_[at(update.a)];
  const Below& b = below_[at(update.b)];
  const int rows = nodes_[at(a.row)].size, columns = nodes_[at(b.row)].size;
  const double* L_t = scaled_.data() + (a.transposed - first_transposed);
  const double* A_t = transposed_.data() + b.transposed;
  double* target = values_.data() + update.target;
  with_lanes(columns, [&](auto n) {
    for (int r = 0; r < rows; ++r) {
      const LanesRow<n> sum = combine_rows<n>(L_t + r, stride_of(rows), A_t, size);
      for (std::size_t i = 0; i < n; ++i) store_lanes(load_lanes(target + i * kLanes) - sum[i], target + i * kLanes);
      if (update.is_diagonal) scale_[at(first_row_[at(a.row)] + r)] += std::fabs(sum[at(r / kLanes)][r % kLanes]);
      target += n * kLanes;
    }
  });
}

bool BlockLdl::factorize(double tolerance) noexcept {
  scale_ = reference_;
  smallest_pivot_ = 1;
  bool is_regular = true;
  for (std::size_t k = 0; k < order_.size(); ++k) {
    const int node = order_[k], size = nodes_[at(node)].size, row = first_row_[at(node)];
    const double* A = values_.data() + first_value_[at(node)];
    double* inverse = inverse_.data() + first_value_[at(node)];
    switch (nodes_[at(node)].kind) {
      case BlockKind::regular:
        is_regular = invert_block(A, size, inverse) && is_regular;
        break;
      case BlockKind::definite:
        is_regular = factorize_definite(node) && is_regular;
        break;
      case BlockKind::closing:
        smallest_pivot_ = std::min(smallest_pivot_, invert_independent(A, size, scale_.data() + row, tolerance, inverse,
                                                                       is_redundant_.data() + row));
        break;
    }
    if (first_below_[k] == first_below_[k + 1]) continue;
    scale_column(k);
    const int first_transposed = below_[at(first_below_[k])].transposed;
    for (int i = first_update_[k]; i < first_update_[k + 1]; ++i) update(updates_[at(i)], size, first_transposed);
    for (int i = first_below_[k]; i < first_below_[k + 1]; ++i) {
      const Below& below = below_[at(i)];
      const int rows = nodes_[at(below.row)].size;
      const double* L_t = scaled_.data() + (below.transposed - first_transposed);
      std::copy_n(L_t, size * stride_of(rows), transposed_.data() + below.transposed);
      transpose_block(L_t, size, rows, values_.data() + below.value);
    }
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
    // the rows of one body leave most of the others out
    if (std::all_of(x, x + size, [](double value) { return value == 0; })) continue;
    if (is_definite) substitute_forward(inverse, size, x);
    for (int i = first_below_[k]; i < first_below_[k + 1]; ++i) {
      const Below& below = below_[at(i)];
      subtract_rows(x, transposed_.data() + below.transposed, size, nodes_[at(below.row)].size,
                    b.data() + first_row_[at(below.row)]);
    }
    if (is_definite) continue;
    std::array<double, kMaxBlock> y;
    with_lanes(size, [&](auto n) {
      const LanesRow<n> sum = combine_rows<n>(x, 1, inverse, size);
      for (std::size_t i = 0; i < n; ++i) store_lanes(sum[i], y.data() + i * kLanes);
    });
    std::copy_n(y.begin(), size, x);
  }
  for (std::size_t k = order_.size(); k-- > 0;) {
    const int node = order_[k], size = nodes_[at(node)].size;
    double* x = b.data() + first_row_[at(node)];
    for (int i = first_below_[k]; i < first_below_[k + 1]; ++i) {
      const Below& below = below_[at(i)];
      subtract_rows(b.data() + first_row_[at(below.row)], values_.data() + below.value, nodes_[at(below.row)].size,
                    size, x);
    }
    if (nodes_[at(node)].kind == BlockKind::definite) {
      substitute_backward(inverse_.data() + first_value_[at(node)], size, x);
    }
  }
}

}  // namespace slew::math
