// SPDX-License-Identifier: Apache-2.0
// Oil cooler: a heat exchanger in a line, with the pressure drop of its tubes.
//
//   Q = K root(p_1 - p_2),   K = nominal_flow / sqrt(nominal_pressure_drop)                                     (1)
//   T_out = T_c + (T_in - T_c) exp(-G/(rho c |Q|))                                                              (2)
//   P = rho c |Q| (T_in - T_out)                                                                                (3)
// T_in of the volume that gives the oil, T_c of the coolant, G conductance k A between oil and coolant [W/K], P heat
// taken out of the oil. The coolant's temperature does not change along the tubes: air or water in plenty. The drop of
// the pressure heats the oil as that of an orifice does. A coolant that is warmer heats the oil. In a circuit whose oil
// has one temperature it is a restriction alone, with a warning.
//
// Source: (2) is the effectiveness 1 - exp(-NTU) of a heat exchanger with one constant temperature (Incropera 2007,
// section 11.4). Not covered: G over the flows of oil and air, thermostat, content of the cooler (a hose or
// rigid_volume at a port), bypass (a check_valve beside it).
#pragma once

#include "hydraulics/component_def.h"

namespace slew::hydraulics {

struct CoolerDef final : ComponentDef {
  std::string port_1, port_2;           // volumes
  double nominal_flow = 0;              // m3/s ...
  double nominal_pressure_drop = 1e5;   // Pa ... at this drop
  double conductance = 0;               // W/K
  double coolant_temperature = 293.15;  // K

  [[nodiscard]] std::string_view type_name() const noexcept override { return "cooler"; }
  [[nodiscard]] void* address() noexcept override { return this; }
  void add_lines(PumpLines& lines) const override;
};

[[nodiscard]] ComponentType cooler_type();

}  // namespace slew::hydraulics
