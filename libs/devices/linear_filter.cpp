// SPDX-License-Identifier: Apache-2.0
#include "devices/linear_filter.h"

#include <algorithm>
#include <cmath>

#include "core/check.h"

namespace slew::devices {
namespace {

constexpr std::size_t kAugmented = kMaxFilterOrder + 1;
constexpr int kTaylorTerms = 20;  // of a matrix with norm 1/2: the next term is below 1e-25
constexpr double kLargestScaledNorm = 0.5;

using Matrix = std::array<std::array<double, kAugmented>, kAugmented>;

Matrix product(const Matrix& a, const Matrix& b) {
  Matrix c{};
  for (std::size_t i = 0; i < kAugmented; ++i) {
    for (std::size_t j = 0; j < kAugmented; ++j) {
      for (std::size_t k = 0; k < kAugmented; ++k) c[i][j] += a[i][k] * b[k][j];
    }
  }
  return c;
}

double norm(const Matrix& a) {
  double largest = 0;
  for (const auto& row : a) {
    double sum = 0;
    for (const double x : row) sum += std::abs(x);
    largest = std::max(largest, sum);
  }
  return largest;
}

// e^a by scaling and squaring
Matrix exponential(Matrix a) {
  int halvings = 0;
  for (double n = norm(a); n > kLargestScaledNorm; n /= 2) ++halvings;
  for (auto& row : a) {
    for (double& x : row) x = std::ldexp(x, -halvings);
  }
  Matrix sum{}, term{};
  for (std::size_t i = 0; i < kAugmented; ++i) sum[i][i] = term[i][i] = 1;
  for (int n = 1; n <= kTaylorTerms; ++n) {
    term = product(term, a);
    for (std::size_t i = 0; i < kAugmented; ++i) {
      for (std::size_t j = 0; j < kAugmented; ++j) {
        term[i][j] /= n;
        sum[i][j] += term[i][j];
      }
    }
  }
  for (int n = 0; n < halvings; ++n) sum = product(sum, sum);
  return sum;
}

}  // namespace

LinearFilter build_filter(std::size_t order, const std::array<double, kMaxFilterOrder>& coefficients,
                          double step) noexcept {
  SLEW_CHECK((order == 2 || order == 3) && step > 0);
  Matrix a{};
  for (std::size_t i = 0; i + 1 < order; ++i) a[i][i + 1] = step;
  for (std::size_t j = 0; j < order; ++j) a[order - 1][j] = -coefficients[j] * step;
  a[order - 1][kMaxFilterOrder] = step;  // the input, constant
  const Matrix e = exponential(a);
  LinearFilter filter;
  filter.order = order;
  for (std::size_t i = 0; i < order; ++i) {
    for (std::size_t j = 0; j < order; ++j) filter.transition[i][j] = e[i][j];
    filter.input[i] = e[i][kMaxFilterOrder];
  }
  return filter;
}

void advance(const LinearFilter& filter, double u, FilterState& state) noexcept {
  std::array<double, kMaxFilterOrder> next{};
  for (std::size_t i = 0; i < filter.order; ++i) {
    next[i] = filter.input[i] * u;
    for (std::size_t j = 0; j < filter.order; ++j) next[i] += filter.transition[i][j] * state.z[j];
  }
  state.z = next;
}

}  // namespace slew::devices
