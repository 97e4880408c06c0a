// SPDX-License-Identifier: Apache-2.0
// Metering orifice with an ideal pressure compensator: flow independent of the load while the supply suffices.
//
//   dp = min(compensator_pressure, max(0, p_P - p_A))
//   Q_PA = opening C_d A root(2 dp / rho)
//   p_LS = p_A - p_T
//
// The compensator also holds the load (no flow from A to P). Source: Merritt 1967 (orifice), load-sensing practice.
// Not covered: drop and dynamics of the compensator.
#pragma once

#include "hydraulics/component_def.h"

namespace slew::hydraulics {

struct CompensatedOrificeDef final : ComponentDef {
  std::string port_p, port_a, port_t;  // volumes; T is the reference of the LS pressure only
  double area = 0;                     // m2, fully open
  double discharge_coefficient = 0.67;
  double compensator_pressure = 8e5;  // Pa held across the orifice
  double opening = 1;                 // fraction of the area

  [[nodiscard]] std::string_view type_name() const noexcept override { return "compensated_orifice"; }
  [[nodiscard]] void* address() noexcept override { return this; }
  void add_lines(PumpLines& lines) const override;
};

[[nodiscard]] ComponentType compensated_orifice_type();

}  // namespace slew::hydraulics
