// SPDX-License-Identifier: Apache-2.0
#include "tests/validation/flexible/slender_beam.h"

#include <cmath>

namespace slew::testing {

double SlenderBeam::euler_load() const {
  return M_PI * M_PI * EI / (4 * length * length);
}

SlenderBeam::End SlenderBeam::shoot(double square, double load, double M_root, double S_root) const {
  constexpr int kSteps = 200;
  using Section = std::array<double, 4>;  // w, w', M, S
  const auto rate = [&](double x, const Section& z) {
    const double T = -compression + spin * spin * (0.5 * rho_A * (length * length - x * x) + tip_mass * length);
    return Section{z[1], z[2] / EI, z[3] + T * z[1], rho_A * square * z[0] + load};
  };
  const auto moved = [](const Section& z, double t, const Section& r) {
    Section y{};
    for (std::size_t k = 0; k < 4; ++k) y[k] = z[k] + t * r[k];
    return y;
  };
  const double h = length / kSteps;
  Section z = {0, 0, M_root, S_root};
  for (int i = 0; i < kSteps; ++i) {
    const double x = i * h;
    const Section a = rate(x, z), b = rate(x + h / 2, moved(z, h / 2, a)), c = rate(x + h / 2, moved(z, h / 2, b)),
                  d = rate(x + h, moved(z, h, c));
    for (std::size_t k = 0; k < 4; ++k) z[k] += h / 6 * (a[k] + 2 * b[k] + 2 * c[k] + d[k]);
  }
  return {z[0], z[2], z[3] + tip_mass * square * z[0]};
}

double SlenderBeam::determinant(double square) const {
  const End a = shoot(square, 0, 1, 0), b = shoot(square, 0, 0, 1);
  return a.M * b.S - b.M * a.S;
}

double SlenderBeam::lowest_square() const {
  const double scale = EI / (std::pow(length, 3) * (tip_mass + 0.25 * rho_A * length)), step = 0.05 * scale;
  double low = -2 * scale, at_low = determinant(low), high = low;
  for (double found = at_low; found * at_low > 0; found = determinant(high)) low = high, high += step;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (determinant(middle) * at_low > 0 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

double SlenderBeam::tip_under(double load) const {
  const End own = shoot(0, load, 0, 0), a = shoot(0, 0, 1, 0), b = shoot(0, 0, 0, 1);
  const double D = a.M * b.S - b.M * a.S;
  const double M = (-own.M * b.S + b.M * own.S) / D, S = (-a.M * own.S + own.M * a.S) / D;
  return own.w + M * a.w + S * b.w;
}

namespace {

// complete elliptic integral of the first kind, by the arithmetic-geometric mean
double elliptic_K(double p) {
  double a = 1, b = std::sqrt(1 - p * p);
  for (int i = 0; i < 8; ++i) {
    const double mean = 0.5 * (a + b);
    b = std::sqrt(a * b);
    a = mean;
  }
  return M_PI / (2 * a);
}

}  // namespace

double elastica_tip(double ratio) {
  double low = 0, high = 0.999;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (2 * elliptic_K(middle) / M_PI < std::sqrt(ratio) ? low : high) = middle;
  }
  return 2 * low / elliptic_K(low);
}

}  // namespace slew::testing
