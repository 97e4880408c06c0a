// SPDX-License-Identifier: Apache-2.0
#include "coupling/static_forces.h"

#include <algorithm>
#include <cmath>

#include "core/check.h"
#include "coupling/samples.h"
#include "math/range_projector.h"
#include "math/small_solve.h"

namespace slew::coupling {

namespace {

// limit of the remaining accelerations, relative to the largest free one
constexpr double kResidualTolerance = 1e-8;

// The F of least norm with W F = b: F = L (L^T L)^-2 L^T b.
bool share_between_ports(const PortMatrix& L, std::size_t m, std::size_t rank, std::span<double> F) noexcept {
  PortArray z;
  z.resize(rank);
  for (std::size_t r = 0; r < rank; ++r) {
    z[r] = 0;
    for (std::size_t i = 0; i < m; ++i) z[r] += L[i * m + r] * F[i];
  }
  for (int times = 0; times < 2; ++times) {
    PortMatrix gram;
    gram.resize(rank * rank);
    for (std::size_t r = 0; r < rank; ++r) {
      for (std::size_t s = 0; s < rank; ++s) {
        gram[r * rank + s] = 0;
        for (std::size_t i = 0; i < m; ++i) gram[r * rank + s] += L[i * m + r] * L[i * m + s];
      }
    }
    if (rank > 0 && !math::solve_in_place(gram.data(), z.data(), rank, 1)) return false;
  }
  for (std::size_t i = 0; i < m; ++i) {
    F[i] = 0;
    for (std::size_t r = 0; r < rank; ++r) F[i] += L[i * m + r] * z[r];
  }
  return true;
}

bool holds(std::span<const double> W, std::span<const double> a_free, std::span<const double> F) noexcept {
  const std::size_t m = F.size();
  double largest = 0;
  for (const double a : a_free) largest = std::max(largest, std::fabs(a));
  for (std::size_t i = 0; i < m; ++i) {
    double a = a_free[i];
    for (std::size_t j = 0; j < m; ++j) a += W[i * m + j] * F[j];
    if (!(std::fabs(a) <= kResidualTolerance * largest)) return false;
  }
  return true;
}

}  // namespace

bool static_forces(std::span<const double> W, std::span<const double> a_free, std::span<double> F) noexcept {
  const std::size_t m = a_free.size();
  SLEW_CHECK(m <= kMaxPorts && F.size() == m && W.size() == m * m);
  for (std::size_t i = 0; i < m; ++i) F[i] = -a_free[i];
  PortMatrix L;
  PortArray left;
  L.resize(m * m);
  left.resize(m);
  const std::size_t rank = math::pivoted_cholesky(W, L.span(), left.span());
  if (rank < m) return share_between_ports(L, m, rank, F) && holds(W, a_free, F);
  PortMatrix matrix;
  matrix.resize(m * m);
  std::copy(W.begin(), W.end(), matrix.begin());
  return math::solve_in_place(matrix.data(), F.data(), m, 1);
}

}  // namespace slew::coupling
