// SPDX-License-Identifier: Apache-2.0
// Brake at an end of a cylinder's stroke: near the end a plunger shuts the port, and the oil that the piston still
// displaces leaves through a throttle. Quasi-static: the flow through the throttle is the piston's displacement.
//
//   Q = A_c c                                        c: speed towards the end [m/s], A_c: area of the enclosed oil  (1)
//   Q = K(s)/w dp/(dp^2 + p_t^2)^(1/4)               K: flow coefficient over the remaining stroke s               (2)
//   w = min(1, (L - s)/e),  no brake for s >= L      L: length; e: way on which the plunger shuts the port         (3)
//   f = A_c dp                                       against the motion; f c >= 0                                  (4)
// (2) is the law of an orifice, K = C_d A sqrt(2/rho), linear below p_t; solved for dp with q = w Q/K,
//   dp^2 = (q^4 + q^2 sqrt(q^4 + 4 p_t^2))/2.                                                                      (5)
// Way out of the end, c < 0: a check valve lets the oil in freely, dp = 0, or the throttle carries it, dp < 0.
// Source: Merritt 1967 for the orifice; (1), (3) and (4) are balances of oil and force. Not covered: compressibility of
// the enclosed oil, its cavitation, leaks past the plunger beside K.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace slew::math {

struct CushionDef {
  double length = 0;                                     // L [m]; 0: no cushion
  double entry = 0;                                      // e [m], 0 < e <= L
  double area = 0;                                       // A_c [m2]
  double transition = 0;                                 // p_t [Pa], > 0
  std::vector<std::array<double, 2>> conductances = {};  // s [m], K [m3/s/sqrt(Pa)] > 0; straight lines, ends held
  bool has_check_valve = true;
};

// Brake at one instant and its slopes.
struct CushionBrake {
  double drop = 0;         // dp [Pa], pressure of the enclosed oil above that of the chamber
  double force = 0;        // f [N]
  double d_remaining = 0;  // df/ds [N/m]
  double d_closing = 0;    // df/dc [N s/m]
};

class Cushion {
 public:
  Cushion() = default;  // none
  // Pre-condition: arguments of the conductances strictly increasing.
  explicit Cushion(const CushionDef& def) : def_(def) {}

  [[nodiscard]] bool exists() const noexcept { return def_.length > 0; }
  [[nodiscard]] const CushionDef& def() const noexcept { return def_; }
  // s [m], c [m/s]; real-time safe.
  [[nodiscard]] CushionBrake at(double remaining, double closing) const noexcept;

 private:
  struct Line {
    double value, slope;
  };
  [[nodiscard]] Line conductance(double remaining) const noexcept;

  CushionDef def_;
};

inline Cushion::Line Cushion::conductance(double remaining) const noexcept {
  const auto& points = def_.conductances;
  if (remaining <= points.front()[0]) return {points.front()[1], 0};
  for (std::size_t i = 1; i < points.size(); ++i) {
    if (remaining >= points[i][0]) continue;
    const double slope = (points[i][1] - points[i - 1][1]) / (points[i][0] - points[i - 1][0]);
    return {points[i - 1][1] + slope * (remaining - points[i - 1][0]), slope};
  }
  return {points.back()[1], 0};
}

inline CushionBrake Cushion::at(double remaining, double closing) const noexcept {
  if (!(remaining < def_.length) || (closing < 0 && def_.has_check_valve)) return {};
  const Line K = conductance(remaining);
  const double depth = def_.length - remaining;
  const bool is_shutting = depth < def_.entry;
  const double w = is_shutting ? depth / def_.entry : 1, w_slope = is_shutting ? -1 / def_.entry : 0;
  const double per_speed = def_.area / K.value;
  // (5)
  const double q = w * per_speed * std::fabs(closing), r = q * q, p_t = def_.transition;
  const double drop = std::sqrt(0.5 * r * (r + std::sqrt(r * r + 4 * p_t * p_t)));
  // dq/d(dp) of (2)
  const double size = drop * drop + p_t * p_t;
  const double inverse = std::sqrt(std::sqrt(size)) / (1 - 0.5 * drop * drop / size);
  const double sign = closing < 0 ? -1.0 : 1.0;
  const double q_per_way = per_speed * std::fabs(closing) * (w_slope - w * K.slope / K.value);
  return {.drop = sign * drop,
          .force = sign * def_.area * drop,
          .d_remaining = sign * def_.area * inverse * q_per_way,
          .d_closing = def_.area * inverse * w * per_speed};
}

}  // namespace slew::math
