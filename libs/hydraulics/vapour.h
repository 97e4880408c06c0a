// SPDX-License-Identifier: Apache-2.0
// Cavitation of a volume: the meaning of its state below the cavitation floor.
//
// A volume's state u [Pa] is its pressure down to the floor p_f. Below, it is the pressure of oil in tension and
// measures the room without oil:
//   p = u                                        u >= p_f                                            (1)
//   p = p_f/2 (1 + exp(2 (u - p_f)/p_f))         u <  p_f, slope 1 at the floor                       (2)
//   V_void = C_f (p_f - u),  V_void' = -sum Q    u <  p_f                                             (3)
// C_f is the volume's capacity on reaching the floor, constant until the oil has filled the room again: (3) is linear
// in u and in the strokes, so that every integration method keeps the oil of a closed volume to rounding at any
// tolerance, and u passes the floor without a bend. The pressure alone cannot serve as the state: between p_f and zero
// it has one value for any amount of vapour.
//
// C jumps at the floor, by 1e4 in oil with air. The error estimate of a method measures flows over C and does not see a
// stage that ends far below the floor. Two balances hold whatever the laws of the pressure are:
//   V_void <= 2 h sum Q_out(end of the sub-step)     for a sub-step h in which u passes the floor             (4)
//   V_void <= V                                      no oil is taken from an empty volume                     (5)
// 2 allows for a flow that falls during the sub-step. An Euler sub-step takes h sum Q = C(u_1) (u_1 - u_0) of oil where
// the content changes by int C du:
//   abs(C(u_1) - C(u_0)) abs(u_1 - u_0) / 2 <= share C(u_1) (scale + p)                                       (6)
// Methods advance the measure of a volume's oil in place of u (math/stiff_system.h):
//   w = int_pf^u C_r dp/C_r(p_r) [Pa],   C_r = sum V_k (kappa_oil + 1/B_k) of the rigid contents and hoses (7)
// continued with its slope at the floor below it; kappa_oil alone without such contents. Where no piston moves, w' is
// the flow over a constant: the oil is kept to rounding through the floor. p_r = 100 bar. cvode and implicit_euler
// advance w everywhere; rodas3, whose sub-step begins at u, where
//   w'(u) > 2                                                                                        (8)
// Not covered: dissolved air, inertia of collapsing bubbles.
#pragma once

#include <cmath>
#include <vector>

#include "hydraulics/smooth.h"

namespace slew::hydraulics {

// Limit of (2): the pressure at much vapour.
[[nodiscard]] inline double vapour_pressure_of(double floor) noexcept {
  return 0.5 * floor;
}

// (2): pressure and slope over u; pre-condition: u < floor.
[[nodiscard]] inline ValueSlope vapour_pressure(double u, double floor) noexcept {
  const double slope = std::exp(2 * (u - floor) / floor);
  return {0.5 * floor * (1 + slope), slope};
}

// (7) with its derivatives over u.
struct OilMeasure {
  double value, slope, bend;
};

// Cavitation data of all volumes of a circuit.
struct Vapour {
  std::vector<double> begins_below;  // Pa; -infinity: this volume does not cavitate
  std::vector<double> capacity;      // C_f [m3/Pa]

  [[nodiscard]] bool is_in(std::size_t volume, const double* y) const noexcept {
    return y[volume] < begins_below[volume];
  }
  // (1), (2)
  [[nodiscard]] ValueSlope pressure(std::size_t volume, double u) const noexcept {
    return u < begins_below[volume] ? vapour_pressure(u, begins_below[volume]) : ValueSlope{u, 1};
  }
  // Room without oil [m3].
  [[nodiscard]] double void_volume(std::size_t volume, const double* y) const noexcept {
    return is_in(volume, y) ? capacity[volume] * (begins_below[volume] - y[volume]) : 0;
  }
};

}  // namespace slew::hydraulics
