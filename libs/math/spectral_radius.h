// SPDX-License-Identifier: Apache-2.0
// Largest |eigenvalue| of a square matrix by power iteration, and the state with the largest part in it.
//
//   w = D^-1 A D v / |v|,   |lambda|_max ~ sqrt(|A_s v_k+1| |A_s v_k|),  A_s = D^-1 A D                       (1)
//
// D holds the typical sizes of the states, so that pressures and positions weigh alike; the mean over two iterations
// follows a complex pair. The vector is kept between calls: a matrix that changes slowly needs few iterations each.
// Source: Golub and Van Loan 2013, Matrix Computations, section 7.3. The estimate approaches the value from below when
// two eigenvalues are nearly equal, and may exceed it for strongly non-normal matrices. Real-time safe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/state_bytes.h"

namespace slew::math {

class SpectralRadius {
 public:
  // scale: typical size of each state, > 0. Matrices come row-major with `stride` columns.
  SpectralRadius(std::span<const double> scale, std::size_t stride);

  // Continues with the matrix A for an even number of iterations; |lambda|_max in the units of A.
  double update(const double* A, int iterations) noexcept;
  // The state with the largest part in the last vector.
  [[nodiscard]] std::int32_t owner() const noexcept;
  void restart() noexcept;
  // The iteration vector, as the start of an update.
  void save(StateWriter& bytes) const { bytes.numbers(v_); }
  void load(StateReader& bytes) noexcept { bytes.numbers(v_); }

 private:
  double multiply(const double* A) noexcept;

  std::vector<double> scale_;
  std::size_t stride_;
  std::vector<double> v_, w_;
};

}  // namespace slew::math
