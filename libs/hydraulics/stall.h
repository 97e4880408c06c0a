// What a circuit presses with when its pistons cannot move: the pressures at which every flow has ended.
//
// The pistons are held at their strokes, all chambers begin without load, one control signal is held, and the circuit
// runs until no pressure changes any more. What limits the pressure then is what limits it in the machine: relief
// valves, load-sensing limits, pump settings, leaks, whatever components the circuit has. Not covered: pressures that a
// load from outside makes.
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
