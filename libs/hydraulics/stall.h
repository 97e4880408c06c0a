// SPDX-License-Identifier: Apache-2.0
// Stall pressures of a circuit: the pistons cannot move and every flow has ended.
//
// The pistons are held at their strokes, all chambers begin without load, one control signal is held, and the circuit
// runs until no pressure changes any more. The limits are those of the machine: relief valves, load-sensing limits,
// pump settings, leaks and any other component. Not covered: pressures caused by an external load.
//
// What a pump delivers while its swash returns raises the pressures beyond those that it holds, and pistons that do not
// move and valves without leak keep them. So the circuit then runs with a drain: each step of dt takes the share dt / T
// of a pressure's rise above its start out of every volume, T = 1 s for 1 s. If a chamber's pressure is another one 1 s
// after the drain has closed (0.2 %, 0.2 bar), no flow holds it, and the pressures under a drain with T = 10 s count.
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

// Those of the volumes whose stall pressure no flow restores: neither after a fall by a tenth nor after a rise by a
// tenth and 1 bar does kRestoredShare of the change go back within kRestoredWithin. Their pressure is that of their
// start or of a leak.
[[nodiscard]] std::vector<int> unheld_volumes(const HydraulicsDef& def, std::span<const double> x,
                                              const HeldControl& held, std::span<const int> volumes);

// A pump on its way to full swash restores more, a leak with a time constant above 0.56 s less.
inline constexpr double kRestoredWithin = 0.2;  // s
inline constexpr double kRestoredShare = 0.3;

}  // namespace slew::hydraulics
