// SPDX-License-Identifier: Apache-2.0
#include "multibody/forces/matrix_rules.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace slew::multibody {
namespace {

constexpr std::size_t kSize = 6;
constexpr double kSameValue = 1e-9;       // of the larger entry: both are printed alike
constexpr double kMatrixRounding = 1e-9;  // of a scaled pivot, which is 1 before elimination

}  // namespace

Entry find_asymmetry(const std::vector<double>& matrix) {
  for (std::size_t i = 0; i < kSize; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const double a = matrix[kSize * i + j], b = matrix[kSize * j + i];
      if (std::fabs(a - b) > kSameValue * std::max(std::fabs(a), std::fabs(b)))
        return {static_cast<int>(i), static_cast<int>(j)};
    }
  }
  return {};
}

bool is_positive_semidefinite(std::vector<double> matrix) {
  double scale[kSize];
  for (std::size_t i = 0; i < kSize; ++i) {
    const double pivot = matrix[kSize * i + i];
    if (pivot < 0) return false;
    scale[i] = pivot > 0 ? 1 / std::sqrt(pivot) : 1;
  }
  for (std::size_t i = 0; i < kSize; ++i) {
    for (std::size_t j = 0; j < kSize; ++j) matrix[kSize * i + j] *= scale[i] * scale[j];
  }
  // elimination; a pivot that is gone must leave nothing beside it
  for (std::size_t k = 0; k < kSize; ++k) {
    const double pivot = matrix[kSize * k + k];
    if (pivot < -kMatrixRounding) return false;
    for (std::size_t i = k + 1; i < kSize; ++i) {
      const double below = matrix[kSize * i + k];
      if (pivot <= kMatrixRounding) {
        if (std::fabs(below) > std::sqrt(kMatrixRounding)) return false;
        continue;
      }
      for (std::size_t j = k + 1; j < kSize; ++j) matrix[kSize * i + j] -= below * matrix[kSize * k + j] / pivot;
    }
  }
  return true;
}

}  // namespace slew::multibody
