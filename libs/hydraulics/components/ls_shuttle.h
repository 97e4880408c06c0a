// SPDX-License-Identifier: Apache-2.0
// Load-sensing shuttle: passes the higher of two LS pressures; optionally the LS line behind it as first order.
//
//   p_in = max(p_1, p_2)                    relative to tank
//   T p' = p_in - p,  p_LS = p              line_time_constant T > 0
//   p_LS = p_in                             T = 0
// When every spool behind it is centred the inputs are bled to tank, and the line follows with T.
// Source: the flexible-body tutorial thesis (Saimaa UAS 2017), table 19. Not covered: flow into the LS line.
#pragma once

#include "hydraulics/component_def.h"

namespace slew::hydraulics {

struct LsShuttleDef final : ComponentDef {
  std::string port_1, port_2;     // components with an LS port: valves or shuttles
  double line_time_constant = 0;  // s

  [[nodiscard]] std::string_view type_name() const noexcept override { return "ls_shuttle"; }
  [[nodiscard]] void* address() noexcept override { return this; }
};

[[nodiscard]] ComponentType ls_shuttle_type();

}  // namespace slew::hydraulics
