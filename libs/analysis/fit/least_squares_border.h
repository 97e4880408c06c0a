// SPDX-License-Identifier: Apache-2.0
// The border of the library with Ceres (ceres/): plain doubles and pointers, since Debian's Ceres and its Eigen are
// built for other instructions than ours. Nothing throws across it.
#pragma once

#include <cstddef>

namespace slew::analysis {

struct SquaresProblem {
  // ---- given
  std::size_t unknowns = 0, residuals = 0;
  int most_iterations = 0;
  double difference_step = 0;  // of each unknown
  void* context = nullptr;     // of residuals_at
  // Residuals at `count` points, one after the other; has_value: 0 where a point has none. False ends the search.
  bool (*residuals_at)(void* context, const double* points, std::size_t count, double* residuals,
                       unsigned char* has_value) = nullptr;
  double* u = nullptr;  // start, replaced by the best point

  // ---- found
  bool has_converged = false;
  int iterations = 0;
  double squares_before = 0, squares_after = 0;
  double* covariance = nullptr;  // n x n, of u for residuals of variance 1
  bool has_covariance = false;
  double* column_lengths = nullptr;  // n, of the Jacobian at u
  double* jacobian = nullptr;        // m x n, by rows, at u
  double* residuals_at_u = nullptr;  // m
  char reason[256] = {};
};

using MinimiseSquares = void(SquaresProblem&);
inline constexpr const char* kMinimiseSquares = "slewring_minimise_squares";

}  // namespace slew::analysis
