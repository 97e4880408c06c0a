// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/oil.h"

#include <cmath>

#include "hydraulics/hydraulics_def.h"

namespace slew::hydraulics {
namespace {

constexpr double kHighestTabulated = 4e9;  // Pa; beyond, kappa keeps its last value
constexpr double kLowestFraction = 1e-3;   // share of the floor: the table's lower end

constexpr int kMostIterations = 8;       // quadratic from a linear guess within 1/32 of an octave
constexpr double kSettledShare = 1e-15;  // share of a segment: rounding

// int_0^t of a cubic
double integral(const std::array<double, 4>& c, double t) noexcept {
  return (((c[3] / 4 * t + c[2] / 3) * t + c[1] / 2) * t + c[0]) * t;
}

}  // namespace

OilCompressibility::OilCompressibility(const HydraulicsDef& def)
    : law_(def.oil_law),
      B_(def.oil_bulk_modulus),
      alpha_(def.entrained_air),
      p_0_(def.air_reference_pressure),
      inverse_n_(1 / def.polytropic_exponent),
      a_(def.oil_compressibility),
      peak_(def.oil_density_peak) {
  const auto start_of = [](std::uint64_t bits) { return std::bit_cast<double>(bits << kPartsShift); };
  first_ = leading_bits(kLowestFraction * def.pressure_floor);
  lowest_ = start_of(first_);
  const std::uint64_t last = leading_bits(kHighestTabulated);
  double content = 0;
  for (std::uint64_t bits = first_; bits <= last; ++bits) {
    // cubic with the exact values and slopes at both ends
    const double start = start_of(bits), end = start_of(bits + 1), width = end - start;
    const ValueSlope a = exact(start), b = exact(end);
    const double rise = b.value - a.value, slope_a = a.slope * width, slope_b = b.slope * width;
    segment_.push_back(
        {start, 1 / width, {a.value, slope_a, 3 * rise - 2 * slope_a - slope_b, slope_a + slope_b - 2 * rise}});
    content_.push_back(content);
    content += width * integral(segment_.back().coefficient, 1);
  }
}

double OilCompressibility::content(double p) const noexcept {
  if (!(p > lowest_)) return 0;
  const std::uint64_t index = leading_bits(p) - first_;
  const std::size_t i = index < segment_.size() ? index : segment_.size() - 1;
  const Segment& s = segment_[i];
  const double t = (p - s.start) * s.inverse_width;
  const double within = t > 1 ? integral(s.coefficient, 1) + (t - 1) * at(p).value : integral(s.coefficient, t);
  return content_[i] + within / s.inverse_width;
}

double OilCompressibility::pressure_of(double sum, double wall) const noexcept {
  // the last segment that begins below
  std::size_t low = 0, high = segment_.size();
  while (high - low > 1) {
    const std::size_t middle = (low + high) / 2;
    (content_[middle] + wall * segment_[middle].start <= sum ? low : high) = middle;
  }
  const Segment& s = segment_[low];
  const auto& c = s.coefficient;
  const double width = 1 / s.inverse_width, within = (sum - content_[low] - wall * s.start) * s.inverse_width;
  const double whole = integral(c, 1) + wall;
  if (within >= whole) return s.start + width * (1 + (within - whole) / (((c[3] + c[2]) + c[1]) + c[0] + wall));
  double t = within / whole;
  for (int i = 0; i < kMostIterations; ++i) {
    const double kappa = ((c[3] * t + c[2]) * t + c[1]) * t + c[0] + wall;
    const double step = (within - integral(c, t) - wall * t) / kappa;
    t += step;
    if (std::fabs(step) <= kSettledShare) break;
  }
  return s.start + width * t;
}

// (1), (2)
ValueSlope OilCompressibility::oil_and_air(double p) const noexcept {
  const double oil = std::exp(-(p - p_0_) / B_);
  const double air = alpha_ * std::pow(p_0_ / p, inverse_n_);
  const double V = oil + air;
  const double V_1 = -oil / B_ - air * inverse_n_ / p;
  const double V_2 = oil / (B_ * B_) + air * inverse_n_ * (inverse_n_ + 1) / (p * p);
  return {-V_1 / V, -V_2 / V + V_1 * V_1 / (V * V)};
}

// (3)
ValueSlope OilCompressibility::density_parabola(double p) const noexcept {
  // the top, where kappa is zero, lies above 1300 bar
  const bool is_beyond = p > kHighest;
  const double q = is_beyond ? kHighest : p;
  const double rho = 1 + a_ * q * (1 - q / (2 * peak_)), rho_1 = a_ * (1 - q / peak_), rho_2 = -a_ / peak_;
  const double kappa = rho_1 / rho;
  return {kappa, is_beyond ? 0 : rho_2 / rho - kappa * kappa};
}

ValueSlope OilCompressibility::exact(double p) const noexcept {
  return law_ == OilLaw::density_parabola ? density_parabola(p) : oil_and_air(p);
}

}  // namespace slew::hydraulics
