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
  SLEW_CHECK(stride >= size_ && size_ <= 200);
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
  list_operations(filled);
  std::size_t slot = 0;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      if (!filled[i * n + j]) continue;
      if (pattern.has(order_[i], order_[j])) {
        gather_.push_back({static_cast<std::uint32_t>(order_[i] * stride_ + order_[j]), static_cast<Slot>(slot)});
      }
      ++slot;
    }
  }
}

void PatternLu::list_operations(const std::vector<char>& filled) {
  const std::size_t n = size_;
  // slots row by row
  std::vector<Slot> slot(n * n, 0);
  std::size_t count = 0;
  for (std::size_t i = 0; i < n * n; ++i) {
    if (filled[i]) slot[i] = static_cast<Slot>(count++);
  }
  value_.assign(count, 0);
  for (std::size_t k = 0; k < n; ++k) {
    diagonal_.push_back(slot[k * n + k]);
    std::uint16_t eliminated = 0;
    for (std::size_t i = k + 1; i < n; ++i) {
      if (!filled[i * n + k]) continue;
      const std::size_t before = update_.size();
      for (std::size_t j = k + 1; j < n; ++j) {
        if (filled[k * n + j]) update_.push_back({slot[i * n + j], slot[k * n + j]});
      }
      elimination_.push_back({slot[i * n + k], static_cast<Slot>(update_.size() - before)});
      ++eliminated;
    }
    eliminations_.push_back(eliminated);
  }
  for (std::size_t i = 0; i < n; ++i) {
    Row row{};
    row.begin = static_cast<Slot>(term_.size());
    for (std::size_t j = 0; j < i; ++j) {
      if (filled[i * n + j]) term_.push_back({slot[i * n + j], static_cast<Slot>(j)});
    }
    row.diagonal = static_cast<Slot>(term_.size());
    for (std::size_t j = i + 1; j < n; ++j) {
      if (filled[i * n + j]) term_.push_back({slot[i * n + j], static_cast<Slot>(j)});
    }
    row.end = static_cast<Slot>(term_.size());
    row_.push_back(row);
  }
}

void PatternLu::set_mass(std::span<const double> mass) noexcept {
  for (std::size_t k = 0; k < size_; ++k) mass_[k] = mass[order_[k]];
}

bool PatternLu::factorise(const double* J, double c) noexcept {
  double* const a = value_.data();
  for (double& value : value_) value = 0;
  for (const Gather& g : gather_) a[g.slot] = -J[g.source];
  for (std::size_t k = 0; k < size_; ++k) a[diagonal_[k]] += c * mass_[k];

  const Elimination* entry = elimination_.data();
  const Update* update = update_.data();
  const double smallest = kSmallestPivot * c;
  for (std::size_t k = 0; k < size_; ++k) {
    const double pivot = a[diagonal_[k]];
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
  return true;
}

void PatternLu::solve(double* b) noexcept {
  double* const w = work_.data();
  const double* const a = value_.data();
  for (std::size_t i = 0; i < size_; ++i) {
    double sum = b[order_[i]];
    for (Slot t = row_[i].begin; t != row_[i].diagonal; ++t) sum -= a[term_[t].entry] * w[term_[t].column];
    w[i] = sum;
  }
  for (std::size_t i = size_; i-- > 0;) {
    double sum = w[i];
    for (Slot t = row_[i].diagonal; t != row_[i].end; ++t) sum -= a[term_[t].entry] * w[term_[t].column];
    w[i] = sum * inverse_pivot_[i];
    b[order_[i]] = w[i];
  }
}

}  // namespace slew::math
