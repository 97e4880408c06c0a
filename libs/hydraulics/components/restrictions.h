// SPDX-License-Identifier: Apache-2.0
// Restrictions between two volumes: bleed, orifice, laminar restriction. Flow goes both ways.
//
//   bleed                Q = K root(p_1 - p_2),  K = nominal_flow / sqrt(nominal_pressure_drop)
//   orifice              Q = u C_d A sqrt(2/rho) root(p_1 - p_2)
//   laminar_restriction  Q = pi d^4 / (128 rho nu L) (p_1 - p_2)
//   root(d) = d / (d^2 + d_t^2)^(1/4): square root of the drop, linear below the transition d_t
//
// Source: the flexible-body tutorial thesis (Saimaa UAS 2017), table 2 (throttle; its STEP form has zero conductance at
// dp = 0, so the form above replaces it); Merritt 1967 for the others.
#pragma once

#include "hydraulics/component_def.h"

namespace slew::hydraulics {

struct BleedDef final : ComponentDef {
  std::string port_1, port_2;        // volumes
  double nominal_flow = 0;           // m3/s ...
  double nominal_pressure_drop = 0;  // Pa ... at this drop

  [[nodiscard]] std::string_view type_name() const noexcept override { return "bleed"; }
  [[nodiscard]] void* address() noexcept override { return this; }
  void add_lines(PumpLines& lines) const override;
};

struct OrificeDef final : ComponentDef {
  std::string port_1, port_2;  // volumes
  double diameter = 0;         // m
  double discharge_coefficient = 0.67;
  double opening = 1;  // fraction of the area

  [[nodiscard]] std::string_view type_name() const noexcept override { return "orifice"; }
  [[nodiscard]] void* address() noexcept override { return this; }
  void add_lines(PumpLines& lines) const override;
};

struct LaminarRestrictionDef final : ComponentDef {
  std::string port_1, port_2;  // volumes
  double diameter = 0;         // m
  double length = 0;           // m

  [[nodiscard]] std::string_view type_name() const noexcept override { return "laminar_restriction"; }
  [[nodiscard]] void* address() noexcept override { return this; }
  void add_lines(PumpLines& lines) const override;
};

[[nodiscard]] ComponentType bleed_type();
[[nodiscard]] ComponentType orifice_type();
[[nodiscard]] ComponentType laminar_restriction_type();

}  // namespace slew::hydraulics
