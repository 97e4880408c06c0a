// SPDX-License-Identifier: Apache-2.0
#include "math/pattern_lu.h"

#include <cmath>

#include "core/check.h"

namespace slew::math {
namespace {

// A pivot this much smaller than c would blow up rounding errors by its inverse; dissipative systems stay above c.
constexpr double kSmallestPivot = 1e-3;

// Entries of `a` that eliminating k fills in and the multiply-adds it costs.
std::size_t elimination_cost(const std::vector<char>& a, const std::vector<char>& is_done, std::size_t n,
                             std::size_t k) {
  std::size_t rows = 0, columns = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (i == k || is_done[i]) continue;
    rows += a[i * n + k] != 0;
    columns += a[k * n + i] != 0;
  }
  return rows * columns;
}

}  // namespace

PatternLu::PatternLu(const SparsityPattern& pattern, std::size_t stride)
    : size_(pattern.size()), stride_(stride), mass_(size_, 1), inverse_pivot_(size_), work_(size_) {
  SLEW_CHECK(stride >= size_ && size_ <= kMostUnknowns);
  choose_order(pattern);
}

void PatternLu::choose_order(const SparsityPattern& pattern) {
  const std::size_t n = size_;
  std::vector<char> a(n * n), is_done(n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) a[i * n + j] = pattern.has(i, j);
  }
  for (std::size_t step = 0; step < n; ++step) {
    std::size_t best = n, best_cost = 0;
    for (std::size_t k = 0; k < n; ++k) {
      if (is_done[k]) continue;
      const std::size_t cost = elimination_cost(a, is_done, n, k);
      if (best == n || cost < best_cost) {
        best = k;
        best_cost = cost;
      }
    }
    order_.push_back(best);
    is_done[best] = 1;
    for (std::size_t i = 0; i < n; ++i) {
      if (is_done[i] || !a[i * n + best]) continue;
      for (std::size_t j = 0; j < n; ++j) {
        if (!is_done[j] && a[best * n + j]) a[i * n + j] = 1;
      }
    }
  }
  // the filled pattern in elimination order, and where the given entries come from
  std::vector<char> filled(n * n);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) filled[i * n + j] = a[order_[i] * n + order_[j]];
  }
  number_slots(filled);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      if (!filled[i * n + j]) continue;
      const Slot slot = slot_[i * n + j];
      if (pattern.has(order_[i], order_[j])) {
        gather_.push_back({static_cast<std::uint32_t>(order_[i] * stride_ + order_[j]), slot});
      } else {
        fill_.push_back(slot);
      }
    }
  }
  list_operations(filled);
  slot_.clear();
}

void PatternLu::number_slots(const std::vector<char>& filled) {
  const std::size_t n = size_;
  slot_.assign(n * n, 0);
  std::size_t count = 0;
  for (std::size_t k = 0; k < n; ++k) slot_[k * n + k] = static_cast<Slot>(count++);
  const auto number = [&](std::size_t i, std::size_t begin, std::size_t end, std::vector<Row>& rows,
                          std::vector<Slot>& columns) {
    const std::size_t before = columns.size();
    for (std::size_t j = begin; j < end; ++j) {
      if (!filled[i * n + j]) continue;
      slot_[i * n + j] = static_cast<Slot>(count++);
      columns.push_back(static_cast<Slot>(j));
    }
    if (columns.size() == before) return;
    rows.push_back({static_cast<Slot>(i), static_cast<Slot>(columns.size() - before)});
  };
  for (std::size_t i = 0; i < n; ++i) number(i, 0, i, lower_row_, lower_column_);
  for (std::size_t i = n; i-- > 0;) number(i, i + 1, n, upper_row_, upper_column_);
  value_.assign(count, 0);
}

void PatternLu::list_operations(const std::vector<char>& filled) {
  const std::size_t n = size_;
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t eliminated = elimination_.size();
    for (std::size_t i = k + 1; i < n; ++i) {
      if (!filled[i * n + k]) continue;
      const std::size_t before = update_.size();
      for (std::size_t j = k + 1; j < n; ++j) {
        if (filled[k * n + j]) update_.push_back({slot_[i * n + j], slot_[k * n + j]});
      }
      elimination_.push_back({slot_[i * n + k], static_cast<Slot>(update_.size() - before)});
    }
    eliminations_.push_back(static_cast<Slot>(elimination_.size() - eliminated));
  }
}

void PatternLu::set_mass(std::span<const double> mass) noexcept {
  for (std::size_t k = 0; k < size_; ++k) mass_[k] = mass[order_[k]];
}

bool PatternLu::factorise(const double* J, double c) noexcept {
  double* const a = value_.data();
  for (const Slot slot : fill_) a[slot] = 0;
  for (const Gather& g : gather_) a[g.slot] = -J[g.source];
  for (std::size_t k = 0; k < size_; ++k) a[k] += c * mass_[k];

  const Elimination* entry = elimination_.data();
  const Update* update = update_.data();
  const double smallest = kSmallestPivot * c;
  for (std::size_t k = 0; k < size_; ++k) {
    const double pivot = a[k];
    if (!(std::fabs(pivot) >= smallest) || !std::isfinite(pivot)) return false;
    const double inverse = 1 / pivot;
    inverse_pivot_[k] = inverse;
    for (const Elimination* const last = entry + eliminations_[k]; entry != last; ++entry) {
      const double factor = a[entry->entry] * inverse;
      a[entry->entry] = factor;
      for (const Update* const end = update + entry->updates; update != end; ++update) {
        a[update->target] -= factor * a[update->source];
      }
    }
  }
  // rows of U over their pivots
  double* upper = a + size_ + lower_column_.size();
  for (const Row& row : upper_row_) {
    const double inverse = inverse_pivot_[row.pivot];
    for (const double* const end = upper + row.entries; upper != end; ++upper) *upper *= inverse;
  }
  return true;
}

// Substitution with a factor whose diagonal is one, in work_.
void PatternLu::substitute(const std::vector<Row>& rows, const Slot* column, const double* entry) noexcept {
  double* const w = work_.data();
  for (const Row& row : rows) {
    double sum = w[row.pivot];
    for (const double* const end = entry + row.entries; entry != end; ++entry, ++column) sum -= *entry * w[*column];
    w[row.pivot] = sum;
  }
}

void PatternLu::solve(double* b) noexcept {
  double* const w = work_.data();
  const double* const lower = value_.data() + size_;
  for (std::size_t k = 0; k < size_; ++k) w[k] = b[order_[k]];
  substitute(lower_row_, lower_column_.data(), lower);
  for (std::size_t k = 0; k < size_; ++k) w[k] *= inverse_pivot_[k];
  substitute(upper_row_, upper_column_.data(), lower + lower_column_.size());
  for (std::size_t k = 0; k < size_; ++k) b[order_[k]] = w[k];
}

}  // namespace slew::math
