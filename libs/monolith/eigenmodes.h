// SPDX-License-Identifier: Apache-2.0
// Eigenvalues of a small general matrix and the participation of the states.
//
//   A r = lambda r,   l^T A = lambda l^T                                                              (1)
//   participation of state k:  |P_kk| / sum_j |P_jj|,   P = R (L^T R)^-1 L^T                          (2)
// with R and L the right and left vectors of all equal eigenvalues; for a single one, P_kk = l_k r_k / l^T r (Perez-
// Arriaga, Verghese and Schweppe 1982). Participation does not depend on the units of the states. Dense QR iteration
// after balancing: up to a few hundred states. Not real-time safe: allocates.
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

namespace slew::monolith {

// One eigenvalue, its conjugate included, and those equal to it.
struct Eigenmode {
  std::complex<double> value;         // 1/s, imaginary part >= 0
  int count = 1;                      // multiplicity
  std::vector<double> participation;  // (2), by state
};

struct Eigenmodes {
  std::vector<Eigenmode> modes;  // by falling |lambda|
  int at_rest = 0;               // eigenvalues below kSlowestRate: motions without restoring force
};

// 1/s. Positions without restoring force have two eigenvalues of zero, which differences of the equations spread to the
// root of their rounding, 3e-4 1/s: time constants above 1000 s cannot be distinguished from zero.
inline constexpr double kSlowestRate = 1e-3;

// A: n x n, row-major [1/s, in units of the states]. Empty when the iteration fails.
[[nodiscard]] Eigenmodes eigenmodes(std::span<const double> A, std::size_t n);

// Longest step [s] with which the classical fourth-order Runge-Kutta method does not let exp(lambda t) grow; infinite
// if it grows by itself.
[[nodiscard]] double longest_runge_kutta_step(std::complex<double> lambda) noexcept;

}  // namespace slew::monolith
