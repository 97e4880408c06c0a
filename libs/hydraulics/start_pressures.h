// SPDX-License-Identifier: Apache-2.0
// Pressures of an equilibrium start: the actuators hold the forces F at rest.
//
// An actuator alone: linear cylinders have port B at the return pressure, slew cylinders and motors both ports around
// their mean; a pair is raised when one pressure would fall below 1 bar.
//
// Actuators on common volumes: their pressures p hold all of them at once, in pascal by r_j = F_j / s_j,
//   c_j(p) = p_A - p_B A_B / A_A,   s_j = e_j A_A                                                            (1)
//   min |P (c(p) - r)|,   p >= lowest;   among these the p nearest to its aim                                (2)
// P projects onto the range of the scaled mobility s_j W_jk s_k: where several actuators move the same coordinate, only
// their forces on it count, and the split between them is free. lowest: the return pressure at port B of linear
// cylinders, 1 bar elsewhere. aim: the mean pressure at slew cylinders and motors, lowest elsewhere. A group whose
// members hold their forces with the means of what each of them would have alone keeps these means.
//
// (2) by math/bounded_least_squares.h.
#pragma once

#include <span>
#include <vector>

#include "hydraulics/circuit_builder.h"

namespace slew::hydraulics {

// The circuit at its start; by volume.
struct StartCircuit {
  std::span<const Actuator> actuators;
  std::span<const char> is_fixed;                 // 1: keeps its initial pressure
  std::span<const double> initial_pressure;       // Pa absolute
  double return_pressure = 0, mean_pressure = 0;  // Pa absolute
};

struct StartPressures {
  std::vector<double> pressure;  // Pa absolute, of any size; unused at fixed volumes and without actuator
  std::vector<int> actuator;     // by volume: the last actuator on it, -1: none
  std::vector<double> missing;   // N or Nm, by actuator: P s (r - c), 0 where the pressures hold
};

// F: by actuator [N or Nm], without the part that brakes hold. W: mobility of the actuators' coordinates, row-major;
// empty: each actuator moves a coordinate of its own. Allocates.
[[nodiscard]] StartPressures start_pressures(const StartCircuit& circuit, std::span<const double> F,
                                             std::span<const double> W);

}  // namespace slew::hydraulics
