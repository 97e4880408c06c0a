// SPDX-License-Identifier: Apache-2.0
// Standard errors of fitted values where each signal has errors of its own size.
//
//   C = N (sum_k s_k^2 J_k' J_k) N,   N = (J' J)^-1                                                              (1)
//   s_k^2 = r_k' r_k / f_k,           f_k = m_k - trace(J_k N J_k')                                               (2)
// with residuals r_k and rows J_k of the Jacobian of signal k, m_k samples. The sum of all traces is the number of
// values n: of one signal (2) is r' r / (m - n). One variance for all signals would make the interval too small where
// signals that no value changes are measured more exactly than those that determine it.
// Degrees of freedom of value j by Satterthwaite, with c_k the share of signal k in C_jj:
//   f = C_jj^2 / sum_k (c_k^2 / f_k)                                                                              (3)
// A signal with f_k < 1 has no variance of its own; it takes r' r / (m - n) of all signals. Not covered: errors that
// follow each other in time or between signals.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace slew::analysis {

struct StandardErrors {
  std::vector<double> covariance;  // n x n, (1)
  std::vector<double> freedom;     // by value, (3)
};

// normal_inverse: N, n x n. jacobian: m x n, by rows. samples: m_k by signal, in the order of the residuals. Without
// errors the covariance is 0. Pre-condition: m > n.
[[nodiscard]] StandardErrors standard_errors(std::span<const double> normal_inverse, std::span<const double> jacobian,
                                             std::span<const double> residuals, std::span<const std::size_t> samples);

}  // namespace slew::analysis
