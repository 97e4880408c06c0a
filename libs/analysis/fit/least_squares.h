// SPDX-License-Identifier: Apache-2.0
// Nonlinear least squares with bounds over a function that is a simulation: Ceres Solver (Agarwal, Mierle: Ceres
// Solver, ceres-solver.org), trust region by Levenberg and Marquardt, projected into the bounds.
//
// Unknowns u are in [0, 1]. The Jacobian is that of central differences, of one-sided ones at a bound, with a step that
// exceeds the integrators' error; all points of a Jacobian are computed at once. N = (J' J)^-1 at the minimum is large
// in the direction of what J does not determine; with it standard_errors.h has the covariance of u. Ceres is in a
// library of its own, which this program loads for a fit alone: Debian's Ceres comes with SuiteSparse under the GPL,
// LAPACK and others, and is built for other instructions. Only plain doubles cross its border.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace slew::analysis {

// Step of the differences, as a part of the range of an unknown.
inline constexpr double kDifferenceStep = 1e-3;

// Residuals at several points, all of the same length; none of a point where the function has no value. Empty ends the
// search.
using ResidualsAt =
    std::function<std::vector<std::optional<std::vector<double>>>(std::span<const std::vector<double>> points)>;

struct LeastSquares {
  bool has_converged = false;
  bool was_ended = false;   // the function ended the search
  std::string reason{};     // why it stopped
  std::vector<double> u{};  // best point
  int iterations = 0;
  double squares_before = 0, squares_after = 0;  // r' r
  std::vector<double> normal_inverse{};          // N, n x n; empty: there is no Jacobian at u, or m <= n
  std::vector<double> jacobian{}, residuals{};   // J, m x n by rows, and r at u; empty without N
  // |J_k|: change of the residuals with u_k, by unknown. 0: the unknown changes no residual.
  std::vector<double> effects{};
  // |J_k|^2 (J' J)^-1_kk, by unknown; empty without N. 1 / (1 - R^2) with R, the correlation of column k of J
  // with the nearest combination of the others: by how much the others make the variance of u_k larger.
  std::vector<double> inflations{};
};

// start: in [0, 1]. residuals: their number.
[[nodiscard]] LeastSquares minimise_squares(std::vector<double> start, std::size_t residuals, int most_iterations,
                                            const ResidualsAt& residuals_at);

// False in a build or an installation without Ceres: minimise_squares() then throws Failure (resources).
[[nodiscard]] bool has_least_squares() noexcept;

}  // namespace slew::analysis
