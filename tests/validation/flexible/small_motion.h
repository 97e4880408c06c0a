// Small motion of a mechanism, for frequencies of references: eigenproblems whose solver is compiled once.
#pragma once

#include <complex>
#include <cstddef>
#include <vector>

#include "multibody/defs.h"

namespace slew::multibody::testing {

// n x n, one column after the other.
struct SquareMatrix {
  explicit SquareMatrix(std::size_t size) : n(size), values(size * size, 0.0) {}
  [[nodiscard]] double& operator()(std::size_t row, std::size_t column) { return values[column * n + row]; }

  std::size_t n;
  std::vector<double> values;
};

[[nodiscard]] std::vector<std::complex<double>> eigenvalues(const SquareMatrix& A);

// Squares of small motion about the start [1/s2], ascending: accelerations that displacements cause, by differences,
// are -M^-1 K.
[[nodiscard]] std::vector<double> squares_of(const MechanicsDef& def);

}  // namespace slew::multibody::testing
