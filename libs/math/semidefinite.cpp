#include "math/semidefinite.h"

#include <algorithm>
#include <cstddef>

#include "core/index.h"

namespace slew::math {

namespace {

// the columns of every row of L before its diagonal: what reaches the row over rows that are eliminated before
std::vector<std::vector<int>> columns_with_fill(const std::vector<std::vector<int>>& coupled) {
  const std::size_t n = coupled.size();
  std::vector<std::vector<int>> columns(n);
  std::vector<int> next(n, -1);  // first row after this one that it reaches
  std::vector<int> reached_from(n, -1);
  for (std::size_t k = 0; k < n; ++k) {
    const int row = static_cast<int>(k);
    reached_from[k] = row;
    for (int j : coupled[k]) {
      for (; reached_from[at(j)] != row; j = next[at(j)]) {
        reached_from[at(j)] = row;
        columns[k].push_back(j);
        if (next[at(j)] < 0) next[at(j)] = row;
      }
    }
    std::sort(columns[k].begin(), columns[k].end());
  }
  return columns;
}

}  // namespace

Semidefinite::Semidefinite(int size)
    : lower_(at(size) * at(size)), pivot_(at(size)), row_(at(size)), is_redundant_(at(size)) {
  for (int k = 0; k < size; ++k) rows_.push_back({.first = {0, k, k * size}, .diagonal = k * size + k});
}

Semidefinite::Semidefinite(const std::vector<std::vector<int>>& coupled)
    : pivot_(coupled.size()), row_(coupled.size()), is_redundant_(coupled.size()) {
  int entries = 0;
  for (const std::vector<int>& columns : columns_with_fill(coupled)) add_row(columns, entries);
  lower_.resize(at(entries));
  const std::size_t n = coupled.size();
  is_dense_ = lower_.size() == n * (n + 1) / 2;
}

void Semidefinite::add_row(const std::vector<int>& columns, int& entries) {
  std::vector<Run> runs;
  for (const int column : columns) {
    if (runs.empty() || runs.back().end != column) runs.push_back({column, column, entries});
    ++runs.back().end;
    ++entries;
  }
  if (runs.empty()) runs.push_back({0, 0, entries});
  const int more = static_cast<int>(runs_.size());
  runs_.insert(runs_.end(), runs.begin() + 1, runs.end());
  rows_.push_back(
      {.first = runs.front(), .more = more, .more_end = static_cast<int>(runs_.size()), .diagonal = entries++});
}

int Semidefinite::entry(int row, int column) const noexcept {
  if (row == column) return rows_[at(row)].diagonal;
  int found = -1;
  for_each_run(rows_[at(row)], [&](const Run& run) {
    if (column >= run.begin && column < run.end) found = run.value + (column - run.begin);
  });
  return found;
}

// L of row k; returns D
double Semidefinite::eliminate(std::size_t k, std::span<const double> a) noexcept {
  double* const row = row_.data();
  for_each_run(rows_[k], [&](const Run& run) {
    const double* entry = a.data() + run.value;
    for (int j = run.begin; j < run.end; ++j, ++entry) {
      if (is_redundant_[at(j)] != 0) continue;
      double sum = *entry;
      for_each_run(rows_[at(j)], [&](const Run& other) {
        const double* L = lower_.data() + other.value;
        for (int i = other.begin; i < other.end; ++i, ++L) sum -= row[i] * *L;
      });
      row[j] = sum;  // L D, divided below
    }
  });
  double rest = a[at(rows_[k].diagonal)];
  for_each_run(rows_[k], [&](const Run& run) {
    double* L = lower_.data() + run.value;
    for (int j = run.begin; j < run.end; ++j, ++L) {
      const double scaled = row[j] * pivot_[at(j)];
      rest -= scaled * row[j];
      *L = scaled;
      row[j] = 0;
    }
  });
  return rest;
}

// the same of a dense matrix, in place
[[gnu::always_inline]] inline double Semidefinite::eliminate_dense(std::size_t k, std::span<const double> a) noexcept {
  const double* given = a.data() + rows_[k].first.value;
  double* const row = lower_.data() + rows_[k].first.value;
  for (std::size_t j = 0; j < k; ++j) {
    row[j] = 0;
    if (is_redundant_[j] != 0) continue;
    const double* other = lower_.data() + rows_[j].first.value;
    double sum = given[j];
    for (std::size_t i = 0; i < j; ++i) sum -= row[i] * other[i];
    row[j] = sum;
  }
  double rest = given[k];
  for (std::size_t j = 0; j < k; ++j) {
    const double scaled = row[j] * pivot_[j];
    rest -= scaled * row[j];
    row[j] = scaled;
  }
  return rest;
}

void Semidefinite::factorize(std::span<const double> a, std::span<const double> reference, double tolerance) noexcept {
  rank_ = 0;
  smallest_pivot_ = 1;
  for (std::size_t k = 0; k < rows_.size(); ++k) {
    const double rest = is_dense_ ? eliminate_dense(k, a) : eliminate(k, a), own = a[at(rows_[k].diagonal)];
    const double scale = reference.empty() ? own : std::max(own, reference[k]);
    smallest_pivot_ = std::min(smallest_pivot_, scale > 0 ? rest / scale : 0.0);
    const bool is_independent = rest > tolerance * scale;
    is_redundant_[k] = is_independent ? 0 : 1;
    pivot_[k] = is_independent ? 1 / rest : 0;
    rank_ += is_independent ? 1 : 0;
  }
}

void Semidefinite::forward(std::size_t row, std::span<double> b) const noexcept {
  double x = b[row];
  for_each_run(rows_[row], [&](const Run& run) {
    const double* L = lower_.data() + run.value;
    for (int j = run.begin; j < run.end; ++j, ++L) x -= *L * b[at(j)];
  });
  b[row] = is_redundant_[row] != 0 ? 0 : x;
}

void Semidefinite::backward(std::size_t row, std::span<double> b) const noexcept {
  const double x = b[row];
  for_each_run(rows_[row], [&](const Run& run) {
    const double* L = lower_.data() + run.value;
    for (int j = run.begin; j < run.end; ++j, ++L) b[at(j)] -= *L * x;
  });
}

void Semidefinite::solve_dense(std::span<double> b) const noexcept {
  const std::size_t n = pivot_.size();
  for (std::size_t k = 0; k < n; ++k) {
    const double* row = lower_.data() + rows_[k].first.value;
    for (std::size_t j = 0; j < k; ++j) b[k] -= row[j] * b[j];
    if (is_redundant_[k] != 0) b[k] = 0;
  }
  for (std::size_t k = 0; k < n; ++k) b[k] *= pivot_[k];
  for (std::size_t k = n; k-- > 0;) {
    const double* row = lower_.data() + rows_[k].first.value;
    for (std::size_t j = 0; j < k; ++j) b[j] -= row[j] * b[k];
  }
}

void Semidefinite::solve(std::span<double> b) const noexcept {
  if (is_dense_) return solve_dense(b);
  for (std::size_t k = 0; k < pivot_.size(); ++k) forward(k, b);
  for (std::size_t k = 0; k < pivot_.size(); ++k) b[k] *= pivot_[k];
  for (std::size_t k = pivot_.size(); k-- > 0;) backward(k, b);
}

void Semidefinite::solve(std::span<const int> rows, std::span<double> b) const noexcept {
  for (const int k : rows) forward(at(k), b);
  for (const int k : rows) b[at(k)] *= pivot_[at(k)];
  for (std::size_t i = rows.size(); i-- > 0;) backward(at(rows[i]), b);
}

}  // namespace slew::math
