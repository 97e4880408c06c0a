// SPDX-License-Identifier: Apache-2.0
// Largest line forces of a machine's cylinders and motors: what the valves press with when the pistons are held
// (hydraulics/stall.h), for the best of every input at full stick to either side, one at a time.
//
//   F_max = F_stall - F_mu(F_stall)        in the direction in which the load is carried                        (1)
// F_mu: the largest friction of the actuator at up to kCreep, since a load that is lifted has to begin to move. The
// limits are those of the circuit: relief valves, load-sensing limits, settings of the pump, leaks.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "hydraulics/circuit.h"
#include "hydraulics/stall.h"
#include "scene/scene.h"

namespace slew::analysis {

struct LargestForce {
  double force = 0;         // N, or N m: (1)
  double pressure = 0;      // Pa absolute, in the loaded chamber
  std::string chamber{};    // volume
  std::string input{};      // input that loads it; empty: none needed
  double stick = 0;         // +1 or -1: its direction, at full stick
  bool is_steady = true;    // false: the pressure still rose after 30 s
  std::size_t command = 0;  // number of the command that loads it
};

class LargestForces {
 public:
  // strokes: of all ports of the scene [m, of motors rad]. The scene must outlive it. Allocates; runs the circuit once
  // for each command.
  LargestForces(const scene::Scene& scene, std::vector<double> strokes);

  // direction: +1 or -1, the sign of the force that carries the load.
  [[nodiscard]] LargestForce of(std::size_t port, double direction) const;
  // The circuit with the present settings of the scene under a command.
  [[nodiscard]] hydraulics::Stall stall(std::size_t command) const;

 private:
  struct Command {
    std::string input;
    double stick = 0;
    hydraulics::HeldControl held;
  };
  void find_commands();

  const scene::Scene& scene_;
  hydraulics::Circuit circuit_;
  std::vector<double> strokes_;
  std::vector<Command> commands_;
  std::vector<hydraulics::Stall> stalls_;
};

}  // namespace slew::analysis
