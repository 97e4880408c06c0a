// SPDX-License-Identifier: Apache-2.0
// A cylinder's chamber as a transmission line of one delay: the circuit's side of coupling level TLM.
//
// The chamber's oil is a line of capacity C between the circuit's volume (end h) and the piston (end m). Waves need the
// delay T, a communication step, from one end to the other and are constant within it:
//   p_h = c_h + Z Q_h,   p_m = c_m - Z S v,   Z = T / C,   S = dV/dx = +A_A or -A_B                        (1)
//   c_m+ = 2 mean(p_h) - c_h,   c_h+ = c_m - 2 Z S mean(v)                                                 (2)
// Q_h [m3/s] flows from the volume into the line; mean() is over the finished step. The oil in the line follows from
// the mean of both waves, p = (c_h + c_m)/2: with (2), C (p+ - p) = T (mean(Q_h) - S mean(v)). C depends on pressure
// and
// stroke; where it changes within a step, c_h+ takes what (2) leaves to  int C dp = int Q_h dt - S dx            (3)
//
// A wave is limited to the vapour pressure (vapour.h). The missing oil is counted as room (LineState::room), which is
// filled again before the line's pressure rises. (4)
//
// kLumpedShare of the chamber stays with the volume, so that its pressure is a state with the time constant 0.01 T also
// where no hose is connected. Sources: Auslander (1968); Krus et al. (1990), transmission lines between the
// parts of a distributed simulation. Not covered: where in the line vapour is, losses.
#pragma once

#include <cstddef>

#include "hydraulics/component.h"

namespace slew::hydraulics {

inline constexpr double kLumpedShare = 0.01;

// State of a line.
struct LineState {
  double c_h = 0;       // Pa, arrives at the volume in this step
  double c_m = 0;       // Pa, arrives at the piston in this step
  double c_m_next = 0;  // Pa, arrives at the piston in the next step
  double held = 0;      // Pa, excess of c_m_next over (2)
  double Z = 0;         // Pa s/m3, impedance of this step
  double Z_next = 0;    // Pa s/m3
  double x = 0;         // m, piston position at the last exchange
  double room = 0;      // m3 without oil, (4)
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
