// SPDX-License-Identifier: Apache-2.0
// Upper bound of a scene's pressures from its valves and sources, and from the columns that its actuators stop:
//
//   p_max = margin (p_tank + ratio p_source + max_i (F_hold,i + F_stop,i) / A_i)                                (1)
//   F_hold = 2 |a_free| / W,   F_stop = |v| sqrt(K / W)                                                         (2)
// i over the ports; ratio: larger over smaller area of an actuator, A the smaller one; p_source that of the open
// reliefs, or without any twice the pump's. A load that is put on at once swings to twice the holding force.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "coupling/samples.h"
#include "hydraulics/circuit.h"
#include "scene/scene.h"

namespace slew::analysis {

class PressureCeiling {
 public:
  explicit PressureCeiling(const scene::Scene& scene);

  // Its reliefs, whatever their keys are called, and the areas of the actuators at the ports, in their order.
  void set_circuit(const hydraulics::Circuit& circuit);
  // Force of a column that stops the present motion.
  void follow(const coupling::MechanismSample& mechanism, const coupling::ActuatorSample& actuators);
  // A load that is put on at once.
  void put_on(const coupling::MechanismSample& mechanism);

  [[nodiscard]] double value() const;  // (1) [Pa]

 private:
  double relief_ = 0, rise_ = 0, pump_ = 0, tank_ = 0;  // Pa
  double ratio_ = 1;
  std::vector<double> area_, holding_, stopping_;  // by port
};

}  // namespace slew::analysis
