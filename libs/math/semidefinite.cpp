// SPDX-License-Identifier: Apache-2.0
#include "math/semidefinite.h"

#include <algorithm>
#include <cstddef>

#include "core/index.h"

namespace slew::math {

namespace {

// the columns of every row of L before its diagonal: all rows coupled to it through rows eliminated before
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
  for (std::size_t k = 0; k < at(size); ++k) rows_.push_back({.diagonal = k * at(size) + k});
}

Semidefinite::Semidefinite(const std::vector<std::vector<int>>& coupled)
    : pivot_(coupled.size()), row_(coupled.size()), is_redundant_(coupled.size()) {
  std::size_t entries = 0;
  for (const std::vector<int>& columns : columns_with_fill(coupled)) {
    const std::size_t first = runs_.size();
    for (const int column : columns) {
      const std::size_t j = at(column);
      if (runs_.size() == first || runs_.back().end != j) runs_.push_back({j, j, entries - j});
      ++runs_.back().end;
      ++entries;
    }
    rows_.push_back({first, runs_.size(), entries++});
  }
  lower_.resize(entries);
  const std::size_t n = coupled.size();
  columns_ = entries == n * (n + 1) / 2 ? Columns::all : Columns::some;
}

int Semidefinite::entry(int row, int column) const noexcept {
  const std::size_t j = at(column);
  if (row == column) return static_cast<int>(rows_[j].diagonal);
  int found = -1;
  const auto look = [&](const Run& run) {
    if (j >= run.begin && j < run.end) found = static_cast<int>(run.offset + j);
  };
  columns_ == Columns::all ? for_each_run<Columns::all>(at(row), look) : for_each_run<Columns::some>(at(row), look);
  return found;
}

// L of row k; returns D
template <Semidefinite::Columns kColumns>
[[gnu::always_inline]] inline double Semidefinite::eliminate(std::size_t k, std::span<const double> a) noexcept {
  double *const row = row_.data(), *const lower = lower_.data();
  for_each_run<kColumns>(k, [&](const Run& run) {
    for (std::size_t j = run.begin; j < run.end; ++j) {
      if (is_redundant_[j] != 0) continue;
      double sum = a[run.offset + j];
      for_each_run<kColumns>(j, [&](const Run& other) {
        const double* L = lower + other.offset;
        for (std::size_t i = other.begin; i < other.end; ++i) sum -= row[i] * L[i];
      });
      row[j] = sum;  // L D, divided below
    }
  });
  double rest = a[rows_[k].diagonal];
  for_each_run<kColumns>(k, [&](const Run& run) {
    double* L = lower + run.offset;
    for (std::size_t j = run.begin; j < run.end; ++j) {
      L[j] = row[j] * pivot_[j];
      rest -= L[j] * row[j];
      row[j] = 0;
    }
  });
  return rest;
}

template <Semidefinite::Columns kColumns>
void Semidefinite::factorize_rows(std::span<const double> a, std::span<const double> reference,
                                  double tolerance) noexcept {
  rank_ = 0;
  smallest_pivot_ = 1;
  for (std::size_t k = 0; k < rows_.size(); ++k) {
    const double rest = eliminate<kColumns>(k, a), own = a[rows_[k].diagonal];
    const double scale = reference.empty() ? own : std::max(own, reference[k]);
    smallest_pivot_ = std::min(smallest_pivot_, scale > 0 ? rest / scale : 0.0);
    const bool is_independent = rest > tolerance * scale;
    is_redundant_[k] = is_independent ? 0 : 1;
    pivot_[k] = is_independent ? 1 / rest : 0;
    rank_ += is_independent ? 1 : 0;
  }
}

void Semidefinite::factorize(std::span<const double> a, std::span<const double> reference, double tolerance) noexcept {
  if (columns_ == Columns::all) return factorize_rows<Columns::all>(a, reference, tolerance);
  factorize_rows<Columns::some>(a, reference, tolerance);
}

// row_at(0) to row_at(count - 1) rise
template <Semidefinite::Columns kColumns, typename RowAt>
void Semidefinite::solve_rows(std::size_t count, const RowAt& row_at, std::span<double> b) const noexcept {
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t k = row_at(i);
    double x = b[k];
    for_each_run<kColumns>(k, [&](const Run& run) {
      const double* L = lower_.data() + run.offset;
      for (std::size_t j = run.begin; j < run.end; ++j) x -= L[j] * b[j];
    });
    b[k] = is_redundant_[k] != 0 ? 0 : x;
  }
  for (std::size_t i = 0; i < count; ++i) b[row_at(i)] *= pivot_[row_at(i)];
  for (std::size_t i = count; i-- > 0;) {
    const std::size_t k = row_at(i);
    const double x = b[k];
    for_each_run<kColumns>(k, [&](const Run& run) {
      const double* L = lower_.data() + run.offset;
      for (std::size_t j = run.begin; j < run.end; ++j) b[j] -= L[j] * x;
    });
  }
}

void Semidefinite::solve(std::span<double> b) const noexcept {
  const auto row_at = [](std::size_t i) { return i; };
  if (columns_ == Columns::all) return solve_rows<Columns::all>(at(size()), row_at, b);
  solve_rows<Columns::some>(at(size()), row_at, b);
}

void Semidefinite::solve(std::span<const int> rows, std::span<double> b) const noexcept {
  const auto row_at = [rows](std::size_t i) { return at(rows[i]); };
  if (columns_ == Columns::all) return solve_rows<Columns::all>(rows.size(), row_at, b);
  solve_rows<Columns::some>(rows.size(), row_at, b);
}

}  // namespace slew::math
