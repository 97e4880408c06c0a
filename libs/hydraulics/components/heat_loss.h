// SPDX-License-Identifier: Apache-2.0
// Heat that a volume's oil loses through walls to their surroundings: of a tank, a block, long hoses.
//
//   P = G (T - T_s)                                                                                           (1)
// G conductance k A [W/K], T temperature of the volume, T_s of the surroundings. Surroundings that are warmer, or a
// heater, heat the oil. In a circuit whose oil has one temperature it has no effect, with a warning.
// Not covered: heat capacity of the walls, radiation, G over the temperatures.
#pragma once

#include "hydraulics/component_def.h"

namespace slew::hydraulics {

struct HeatLossDef final : ComponentDef {
  std::string port_1;                        // volume
  double conductance = 0;                    // W/K
  double surroundings_temperature = 293.15;  // K

  [[nodiscard]] std::string_view type_name() const noexcept override { return "heat_loss"; }
  [[nodiscard]] void* address() noexcept override { return this; }
};

[[nodiscard]] ComponentType heat_loss_type();

// Options of the fields of what exchanges heat.
[[nodiscard]] constexpr FieldOptions conductance_options(std::string_view doc) {
  return {.dimension = Dimension::thermal_conductance,
          .range = kNotNegative,
          .presence = Presence::required,
          .change = Change::live,
          .doc = doc};
}
[[nodiscard]] constexpr FieldOptions surroundings_options(std::string_view doc) {
  return {.dimension = Dimension::temperature, .range = kPositive, .change = Change::live, .doc = doc};
}

// effect: what the component does in a circuit whose oil has one temperature.
void warn_without_temperatures(const HydraulicsDef& circuit, const std::string& component, std::string_view effect,
                               Problems& warnings);

}  // namespace slew::hydraulics
