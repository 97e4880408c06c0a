// SPDX-License-Identifier: Apache-2.0
// Temperatures of a circuit's volumes, and their change over a communication step.
//
//   T_i+ = (M_i T_i + sum_j int Q_ji T_j dt + int P_i dt/(rho c)) / (M_i + sum_j int Q_ji dt)                  (1)
// M content of the volume at the beginning of the step [m3]; Q_ji flows of oil into it, which include a heat exchange
// of the conductance G as the flow G/(rho c) of oil at the temperature of the surroundings; P heat [W] (passages.h);
// rho c at the reference temperature. The integrals are those of the trapezoidal rule over the sub-steps, with T of the
// beginning. A mean of temperatures with positive weights, plus heat: stable at any step and content. First order.
//
// Within a step the properties of the oil are constant (oil_properties.h); the compressibility of a volume's content
// gets the offset 1/B(T) - 1/B_1. Model and limits: docs/models/hydraulics_oil_temperature.md.
#pragma once

#include <vector>

#include "hydraulics/oil_properties.h"
#include "hydraulics/passages.h"

namespace slew::hydraulics {

struct OilHeat {
  // def: validated.
  OilHeat(const HydraulicsDef& def, std::size_t actuators, std::size_t states);

  OilPropertyLaw law;
  OilProperties reference;
  double rho_c;              // J/(m3 K)
  double start_temperature;  // K
  bool has_modulus;          // the oil's law is one of a bulk modulus

  // state
  std::vector<double> T;         // K, by volume
  std::vector<double> friction;  // N or Nm against the speed, by actuator
  std::vector<double> power;     // W, mean heat of the last step, by volume

  // by volume: follow from the state
  std::vector<OilProperties> properties;
  std::vector<char> is_held;  // T is constant
  // compressibility of the walls at the reference temperature: m3/Pa by volume, 1/Pa by piece
  std::vector<double> wall, piece_wall;

  // work space of a step
  std::vector<double> content;           // M [m3]
  std::vector<HeatFlow> last, now, sum;  // at the ends of a sub-step, and integrated
  std::vector<double> rates;             // of one component
  std::vector<double> unused;            // contents that are known already
};

}  // namespace slew::hydraulics
