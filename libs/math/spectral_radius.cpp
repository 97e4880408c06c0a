// SPDX-License-Identifier: Apache-2.0
#include "math/spectral_radius.h"

#include <cmath>

namespace slew::math {
namespace {

constexpr double kFresh = 0.05;  // share of the start in the vector of every update

// Neighbouring values differ, so that the start is unlikely to be orthogonal to the wanted vector.
double start_of(std::size_t i) noexcept {
  return 1 + 0.1 * static_cast<double>(i % 7);
}

}  // namespace

SpectralRadius::SpectralRadius(std::span<const double> scale, std::size_t stride)
    : scale_(scale.begin(), scale.end()), stride_(stride), v_(scale.size()), w_(scale.size()) {
  restart();
}

void SpectralRadius::restart() noexcept {
  for (std::size_t i = 0; i < v_.size(); ++i) v_[i] = start_of(i);
}

// v = A_s v / |v|; returns |A_s v| of the unit vector.
double SpectralRadius::multiply(const double* A) noexcept {
  const std::size_t n = v_.size();
  double norm = 0;
  for (std::size_t i = 0; i < n; ++i) {
    double sum = 0;
    for (std::size_t j = 0; j < n; ++j) sum += A[i * stride_ + j] * (scale_[j] * v_[j]);
    w_[i] = sum / scale_[i];
    norm += w_[i] * w_[i];
  }
  norm = std::sqrt(norm);
  if (!(norm > 0) || !std::isfinite(norm)) {
    restart();
    return norm;
  }
  for (std::size_t i = 0; i < n; ++i) v_[i] = w_[i] / norm;
  return norm;
}

double SpectralRadius::update(const double* A, int iterations) noexcept {
  // a part of the start keeps all directions in the vector, so that a growing one is not missed
  for (std::size_t i = 0; i < v_.size(); ++i) v_[i] += kFresh * start_of(i);
  double length = 0;
  for (const double x : v_) length += x * x;
  length = std::sqrt(length);
  for (double& x : v_) x /= length;
  double radius = 0;
  for (int k = 0; k < iterations; k += 2) {
    const double first = multiply(A), second = multiply(A);
    radius = std::sqrt(first * second);
  }
  return radius;
}

std::int32_t SpectralRadius::owner() const noexcept {
  std::size_t largest = 0;
  for (std::size_t i = 0; i < v_.size(); ++i) {
    if (std::fabs(v_[i]) > std::fabs(v_[largest])) largest = i;
  }
  return static_cast<std::int32_t>(largest);
}

}  // namespace slew::math
