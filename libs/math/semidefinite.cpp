#include "math/semidefinite.h"

#include <algorithm>
#include <cstddef>

namespace slew::math {

Semidefinite::Semidefinite(int size)
    : lower_(static_cast<std::size_t>(size) * static_cast<std::size_t>(size)),
      pivot_(static_cast<std::size_t>(size)),
      is_redundant_(static_cast<std::size_t>(size)) {}

void Semidefinite::factorize(std::span<const double> a, std::span<const double> reference, double tolerance) noexcept {
  const std::size_t n = pivot_.size();
  rank_ = 0;
  smallest_pivot_ = 1;
  for (std::size_t k = 0; k < n; ++k) {
    double* row = lower_.data() + k * n;
    double rest = a[k * n + k];
    for (std::size_t j = 0; j < k; ++j) {
      row[j] = 0;
      if (is_redundant_[j] != 0) continue;
      const double* other = lower_.data() + j * n;
      double sum = a[k * n + j];
      for (std::size_t i = 0; i < j; ++i) sum -= row[i] * other[i];
      row[j] = sum;  // L D, divided below
    }
    for (std::size_t j = 0; j < k; ++j) {
      const double scaled = row[j] * pivot_[j];
      rest -= scaled * row[j];
      row[j] = scaled;
    }
    const double scale = reference.empty() ? a[k * n + k] : std::max(a[k * n + k], reference[k]);
    smallest_pivot_ = std::min(smallest_pivot_, scale > 0 ? rest / scale : 0.0);
    is_redundant_[k] = rest > tolerance * scale ? 0 : 1;
    pivot_[k] = is_redundant_[k] != 0 ? 0 : 1 / rest;
    rank_ += is_redundant_[k] != 0 ? 0 : 1;
  }
}

void Semidefinite::solve(std::span<double> b) const noexcept {
  const std::size_t n = pivot_.size();
  for (std::size_t k = 0; k < n; ++k) {
    const double* row = lower_.data() + k * n;
    for (std::size_t j = 0; j < k; ++j) b[k] -= row[j] * b[j];
    if (is_redundant_[k] != 0) b[k] = 0;
  }
  for (std::size_t k = 0; k < n; ++k) b[k] *= pivot_[k];
  for (std::size_t k = n; k-- > 0;) {
    const double* row = lower_.data() + k * n;
    for (std::size_t j = 0; j < k; ++j) b[j] -= row[j] * b[k];
  }
}

}  // namespace slew::math
