// SPDX-License-Identifier: Apache-2.0
// Stall pressures of a circuit: the pistons cannot move and every flow has ended.
//
// The pistons are held at their strokes, all chambers begin without load, one control signal is held, and the circuit
// runs until no pressure changes any more. The limits are those of the machine: relief valves, load-sensing limits,
// pump settings, leaks and any other component. Not covered: pressures caused by an external load.
#pragma once

#include <span>
#include <vector>

#include "hydraulics/hydraulics_def.h"

namespace slew::hydraulics {

// One signal; control -1: none, every control neutral.
struct HeldControl {
  int control = -1;
  double signal = 0;
};

struct Stall {
  std::vector<double> pressures;  // Pa absolute, by volume
  std::vector<double> forces;     // N, p_A A_A - p_B A_B, by actuator
  bool is_steady = false;         // false: pressures still changed after kLongestStall
};

inline constexpr double kLongestStall = 30;  // s

// x: strokes [m], by actuator. def: validated. Allocates; a few milliseconds.
[[nodiscard]] Stall find_stall(const HydraulicsDef& def, std::span<const double> x, const HeldControl& held);

}  // namespace slew::hydraulics
