// SPDX-License-Identifier: Apache-2.0
// A cylinder's chamber as a transmission line of one delay: the circuit's side of coupling level TLM.
//
// The chamber's oil is a line of capacity C between the circuit's volume (end h) and the piston (end m). Waves need the
// delay T, a communication step, from one end to the other and are constant within it:
//   p_h = c_h + Z Q_h,   p_m = c_m - Z S v,   Z = T / C,   S = dV/dx = +A_A or -A_B                        (1)
//   c_m+ = 2 mean(p_h) - c_h,   c_h+ = c_m - 2 Z S mean(v)                                                 (2)
// Q_h [m3/s] flows from the volume into the line; mean() is over the finished step. The oil of the line is counted
// apart from its waves: with V its volume, its pressure p and its room without oil V_r follow over a step from
//   V g(p)' = Q_h - S v,   g(p) = int_{p_f}^{p} (kappa + 1/B) dp            V_r = 0                         (3)
//   V_r' = S v - Q_h,      p = p_f                                          V_r > 0                         (4)
// with T mean(Q_h) = T (mean(p_h) - c_h)/Z, which is what left the volume, and V linear in the displacement: (3) has
// the closed form g+ = g + (T mean(Q_h) - S dx) ln(V+/V)/(V+ - V). What is lost in the waves, by a change of Z or by a
// wave that is held, is not lost in the oil:
//   c_h+ = 2 p - c_m+                                                                                      (5)
// which is (2) where C is constant, and the pressure of vapour (vapour.h) in the place of p where V_r > 0. No wave is
// below the pressure of vapour. Where C more than doubles or halves within a step (air near 1 bar, vapour), (5) alone
// would give c_h twice what (2) misses of p, and that wave runs to and fro. Both waves take it once, with p foreseen by
// the circuit's own piston:
//   c_m+ = 2 mean(p_h) - c_h + (p - p_(2))                                                                  (6)
//
// kLumpedShare of the chamber stays with the volume, so that its pressure is a state with the time constant 0.01 T also
// where no hose is connected. Sources: Auslander (1968); Krus et al. (1990), transmission lines between the
// parts of a distributed simulation. Not covered: where in the line vapour is, losses, walls that soften with pressure.
#pragma once

#include <algorithm>
#include <cstddef>

#include "hydraulics/component.h"

namespace slew::hydraulics {

inline constexpr double kLumpedShare = 0.01;

// State of a line.
struct LineState {
  double c_h = 0;       // Pa, arrives at the volume in this step
  double c_m = 0;       // Pa, arrives at the piston in this step
  double c_m_next = 0;  // Pa, arrives at the piston in the next step
  double held = 0;      // Pa, excess of c_m_next over (2), also by (6)
  double Z = 0;         // Pa s/m3, impedance of this step
  double Z_next = 0;    // Pa s/m3
  double x = 0;         // m, piston position at the last exchange
  double p = 0;         // Pa, of the line's oil, not below the floor, (3)
  double room = 0;      // m3 without oil, (4)

  // Pressure of the waves [Pa]; that of the oil, but for a wave that was held.
  [[nodiscard]] double wave_pressure(double floor) const noexcept { return std::max(0.5 * (c_h + c_m), floor); }
  [[nodiscard]] bool is_apart(double floor) const noexcept { return p != wave_pressure(floor); }
};

struct LineChamber {
  StateIndex volume = 0, position = 0, speed = 0;
  double slope = 0;       // S [m2], of a motor its displacement [m3/rad]
  std::size_t piece = 0;  // piece of the circuit
  bool is_line = false;
  double delay = 0;  // T [s]
  LineState state{};

  // Flow into the line at the pressure p of the volume [m3/s].
  [[nodiscard]] double inflow(double p) const noexcept { return (p - state.c_h) / state.Z; }
};

// A piston between lines: F(v) = force - damping (v - v_ref).
struct LineThrust {
  double force = 0;    // N
  double damping = 0;  // N s/m
};

}  // namespace slew::hydraulics
