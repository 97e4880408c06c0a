// SPDX-License-Identifier: Apache-2.0
// Largest line forces of a machine's cylinders and motors: what the valves press with when the pistons are held
// (hydraulics/stall.h), for the best of every input at full stick to either side, one at a time.
//
//   F_max = F_stall - F_mu(F_stall)        in the direction in which the load is carried                        (1)
// F_mu: the largest friction of the actuator at up to kCreep, since a load that is lifted has to begin to move. The
// limits are those of the circuit: relief valves, load-sensing limits, settings of the pump, leaks.
#pragma once

#include <cstddef>
#include <map>
#include <span>
#include <string>
#include <utility>
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
  [[nodiscard]] LargestForce of_command(std::size_t port, double direction, std::size_t command) const;
  // The command with the largest sum of the ports' stall forces times their weights.
  [[nodiscard]] std::size_t best_command(std::span<const double> weights) const;
  // The circuit with the present settings of the scene under a command.
  [[nodiscard]] hydraulics::Stall stall(std::size_t command) const;

  [[nodiscard]] const std::string& name(std::size_t port) const { return scene_.ports[port].name; }
  [[nodiscard]] const std::string& volume_name(int volume) const { return circuit_.volume_name(volume); }
  // A volume without a fixed pressure on which both ports are; -1: none.
  [[nodiscard]] int shared_volume(std::size_t port, std::size_t other) const;
  // The same if no flow holds its pressure under the command (hydraulics::unheld_volumes()), and it is the chamber that
  // the port presses with in the direction, or port A of one and port B of the other; -1: none. Runs the circuit.
  [[nodiscard]] int unheld_between(std::size_t port, std::size_t other, double direction, std::size_t command);

 private:
  struct Command {
    std::string input;
    double stick = 0;
    hydraulics::HeldControl held;
  };
  void find_commands();
  [[nodiscard]] bool is_held(int volume, std::size_t command);

  const scene::Scene& scene_;
  hydraulics::Circuit circuit_;
  std::vector<double> strokes_;
  std::vector<Command> commands_;
  std::vector<hydraulics::Stall> stalls_;
  std::map<std::pair<std::size_t, int>, bool> is_held_;  // by command and volume: those that were looked for
};

}  // namespace slew::analysis
