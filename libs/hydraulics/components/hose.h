// SPDX-License-Identifier: Apache-2.0
// Hose or pipe: a fixed oil volume with an elastic wall, no pressure loss.
//
//   V = pi/4 D^2 L                                        content
//   B = min(B_max, max(B_e sqrt(p), B_min))               modulus of the wall; p in Pa absolute
//
// Source: the flexible-body tutorial thesis (Saimaa UAS 2017), table 2. With its B_e = 7e9 the law is at its cap at any
// pressure: loading gives a warning. Not covered: friction, inertia and wave travel in the line.
#pragma once

#include "hydraulics/component_def.h"

namespace slew::hydraulics {

struct HoseDef final : ComponentDef {
  std::string volume;                  // connected volume
  double length = 0;                   // m
  double diameter = 0;                 // m, inner
  double bulk_modulus = 7e9;           // B_e of the law, Pa/sqrt(Pa)
  double minimum_bulk_modulus = 70e6;  // B_min, Pa
  double maximum_bulk_modulus = 5e8;   // B_max, Pa

  [[nodiscard]] std::string_view type_name() const noexcept override { return "hose"; }
  [[nodiscard]] void* address() noexcept override { return this; }
};

[[nodiscard]] ComponentType hose_type();

}  // namespace slew::hydraulics
