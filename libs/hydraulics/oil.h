// SPDX-License-Identifier: Apache-2.0
// Compressibility of oil with entrained air. vapour.h describes a volume below the cavitation floor p_f.
//
//   V(p)/V_0 = exp(-(p - p_0)/B) + alpha (p_0/p)^(1/n)                                          (1)
//   kappa(p) = -V'/V                                  1/Pa, the inverse bulk modulus            (2)
//   rho(p)/rho_0 = 1 + a p - a p^2/(2 p_m),  kappa = rho'/rho   instead of (1) as density_parabola    (3)
//
// p absolute; p_0 air reference pressure, alpha air content there, n polytropic exponent. kappa is tabulated once from
// 1e-3 p_f on as piecewise cubics over 32 equal parts of each octave of p (relative error below 1e-6) and read without
// a transcendental function. Sources: the flexible-body tutorial thesis (Saimaa UAS 2017), eq. 22 to 27; the air term
// is the usual polytropic one; (3) as 1 + a p + b p^2 in Naya et al. 2011, p_m = -a/(2 b): kappa keeps its value at
// 1000 bar beyond that, and there is no air. Temperature: oil_heat.h. Not covered: dissolution of air.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include "hydraulics/smooth.h"

namespace slew::hydraulics {

struct HydraulicsDef;
enum class OilLaw : int;

class OilCompressibility {
 public:
  explicit OilCompressibility(const HydraulicsDef& def);

  // kappa [1/Pa] and its slope [1/Pa2] at the absolute pressure p; beyond the table its end values.
  [[nodiscard, gnu::always_inline]] ValueSlope at(double p) const noexcept {
    const std::uint64_t index = leading_bits(p > lowest_ ? p : lowest_) - first_;
    const Segment& s = segment_[index < segment_.size() ? index : segment_.size() - 1];
    const auto& c = s.coefficient;
    const double t = (p - s.start) * s.inverse_width;
    // outside of the table
    if (!(t >= 0)) return {c[0], 0};
    if (t > 1) return {((c[3] + c[2]) + c[1]) + c[0], 0};
    return {((c[3] * t + c[2]) * t + c[1]) * t + c[0], ((3 * c[3] * t + 2 * c[2]) * t + c[1]) * s.inverse_width};
  }
  // int kappa dp from the table's start to p, exact for the kappa of at(); below the start 0.
  [[nodiscard]] double content(double p) const noexcept;
  // The p with content(p) + wall p = sum, to rounding; wall >= 0 [1/Pa]. Pre-condition: p is not below the table.
  [[nodiscard]] double pressure_of(double sum, double wall) const noexcept;
  // (2), (3) evaluated directly, to build the table.
  [[nodiscard]] ValueSlope exact(double p) const noexcept;

  // Limit of validity of (1) and (3) [Pa absolute]: beyond it kappa is continued or held, and steps are flagged.
  static constexpr double kHighest = 1000e5;

  // Start of the table: pressures of volumes without vapour are held there.
  [[nodiscard]] double lowest_pressure() const noexcept { return lowest_; }

 private:
  [[nodiscard]] ValueSlope oil_and_air(double p) const noexcept;
  [[nodiscard]] ValueSlope density_parabola(double p) const noexcept;

  // 32 parts of an octave: the exponent and the five leading bits of the mantissa number them
  static constexpr int kPartsShift = 52 - 5;
  [[nodiscard]] static std::uint64_t leading_bits(double p) noexcept {
    return std::bit_cast<std::uint64_t>(p) >> kPartsShift;
  }

  struct Segment {
    double start, inverse_width;        // Pa, 1/Pa
    std::array<double, 4> coefficient;  // coefficients of the powers of t = (p - start) inverse_width
  };

  OilLaw law_;
  double B_, alpha_, p_0_, inverse_n_, a_, peak_;
  double lowest_;
  std::uint64_t first_ = 0;  // leading bits of the first segment's start
  std::vector<Segment> segment_;
  std::vector<double> content_;  // content() at the start of each segment
};

}  // namespace slew::hydraulics
