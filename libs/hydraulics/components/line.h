// SPDX-License-Identifier: Apache-2.0
// Line with dynamics: a pipe of distributed inertia, compressibility and friction between two volumes, by its modes.
//
//   Momentum and continuity,  dq/dt = -(A/rho) dp/dx - R q,   dp/dt = -(B/A) dq/dx,   with
//   q = sum_i q_i cos(i pi x/L),  p against sin(i pi x/L),  i = 0..n, give                                         (1)
//   q_i' = g_i A/(rho L) (e_1 - (-1)^i e_2) - A i pi/(rho L) P_i - 8a f_i q_i - 4a sum_k y_ik,   g_0 = 1, g_i = 2 (2)
//   P_i' = B i pi/(A L) q_i
//   y_ik = z_ik + m_k q_i,   z_ik' = -n_k a y_ik,   k = 1..3,   a = 4 nu/D^2                                       (3)
//   Q_1 = sum_i q_i,   Q_2 = sum_i (-1)^i q_i                                                                      (4)
//   e_1 = p_1 - Z_1 |Q_1| Q_1,   e_2 = p_2 + Z_2 |Q_2| Q_2,   Z = loss rho/(2 A^2)      minor losses at the ends   (5)
//   f_0 = 1 + (0.3164 Re^(3/4)/64 - 1) clip((Re - 2300)/1700, 0, 1),   Re = |q_0| D/(A nu);   f_i = 1              (6)
// Q_1 flow from port 1 into the line, Q_2 from the line into port 2; A, D, L area, diameter, length; rho, nu density
// and viscosity of the oil, B effective bulk modulus of oil and wall. i pi sqrt(B/rho)/L are the natural frequencies of
// a line between two volumes. (3) is laminar friction that depends on the frequency: three exponentials in the place of
// the exact weighting function of the past accelerations. (6) blends steady laminar friction into that of Blasius for a
// smooth pipe. What the line holds beyond n modes, V (1 - (8/pi^2) sum_{i odd <= n} 1/i^2), is added to the two
// volumes, half each.
//
// Sources: Makinen, Piche and Ellman 2000, for (1) and (2); Zielke 1968 for the friction, Trikha 1975 for m_k and n_k
// in (3); Merritt 1967, section 3.3, for (5) and (6). Not covered: air and cavitation inside of the line, where (1)
// goes on below zero: a pressure below hydraulics.pressure_floor at one of n points between the ends is reported as
// cavitation; unsteady turbulent friction beyond (3), elevation.
#pragma once

#include <cstdint>

#include "hydraulics/component_def.h"

namespace slew::hydraulics {

struct LineDef final : ComponentDef {
  std::string port_1, port_2;  // volumes
  double length = 0;           // m
  double diameter = 0;         // m, inner
  double bulk_modulus = 0;     // Pa of oil and wall together; 0: hydraulics.oil_bulk_modulus
  std::int64_t modes = 5;      // n
  double loss_1 = 0;           // minor losses at port 1 ...
  double loss_2 = 0;           // ... and at port 2, in multiples of rho v^2/2

  [[nodiscard]] std::string_view type_name() const noexcept override { return "line"; }
  [[nodiscard]] void* address() noexcept override { return this; }
  void add_lines(PumpLines& lines) const override;
};

[[nodiscard]] ComponentType line_type();

}  // namespace slew::hydraulics
