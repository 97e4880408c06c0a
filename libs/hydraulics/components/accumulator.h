// SPDX-License-Identifier: Apache-2.0
// Gas accumulator with a bladder, a diaphragm or a piston.
//
//   V_0 f' = Q,   nu = 1 - f                                                                                    (1)
//   p_g = p_0 z nu^-n                                                                                           (2)
//   tau z' = nu^(n - 1) - z   with thermal_time_constant tau;  z = 1 without                                    (3)
//   Q = e K root(band(p - p_g)),   K = nominal_flow / sqrt(nominal_pressure_drop)                               (4)
// f oil in the accumulator over V_0 = gas_volume, nu gas volume over V_0; p pressure of the volume at the port, p_0
// precharge_pressure, n polytropic_exponent, Q flow into the accumulator [m3/s]. band(d) leaves out |d| below
// friction_pressure, the seals of a piston. e = 1 for oil that enters; for oil that leaves it falls from 1 to 0 over
// the last hundredth of V_0, where the bladder closes the oil valve or the piston meets its end: below the precharge
// pressure the accumulator is empty and takes no part.
//
// (3) is the gas in heat exchange with walls at the temperature T_w, m c_v T' = -p_g V_g' - m c_v (T - T_w)/tau, for
// an ideal gas, written for z = (T/T_w) nu^(n - 1), which the flow does not change; n is then the adiabatic exponent.
// Fast cycles follow p_g ~ nu^-n, slow ones p_g ~ 1/nu. Without tau the polytropic law (2) holds from the precharge on.
//
// Sources: Merritt 1967 for (4); Pourmovahed and Otis 1990 for the thermal time constant. Deviation: ideal gas; above
// about 200 bar nitrogen is stiffer. Not covered: compression of the oil inside, mass of oil and piston.
#pragma once

#include "hydraulics/component_def.h"

namespace slew::hydraulics {

struct AccumulatorDef final : ComponentDef {
  std::string port_1;                  // volume
  double gas_volume = 0;               // m3, V_0 at the precharge
  double precharge_pressure = 0;       // Pa absolute, p_0 at the walls' temperature
  double polytropic_exponent = 1.4;    // n
  double thermal_time_constant = 0;    // s; 0: none
  double friction_pressure = 0;        // Pa, of a piston's seals
  double nominal_flow = 0;             // m3/s through the connection ...
  double nominal_pressure_drop = 5e5;  // Pa ... at this drop

  [[nodiscard]] std::string_view type_name() const noexcept override { return "accumulator"; }
  [[nodiscard]] void* address() noexcept override { return this; }
  void add_lines(PumpLines& lines) const override;
};

[[nodiscard]] ComponentType accumulator_type();

}  // namespace slew::hydraulics
