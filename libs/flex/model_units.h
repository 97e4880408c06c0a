// SPDX-License-Identifier: Apache-2.0
// Units of matrices from other finite element codes, and a plausibility check of the model in SI.
//
// A code without units gives matrices in any consistent system. A model in the unit of length L [m], of mass M [kg] and
// of time T [s] becomes SI by x L for positions and, with d = 1 for rows of translations, L for rows of rotations,
//   M_ij' = M d_i d_j M_ij        K_ij' = M / T^2 d_i d_j K_ij                                       (1)
// The check uses quantities that depend on every unit, along the longest direction a of the nodes, of the length l:
//   c = l / sqrt(12) sqrt(u^T K u / u^T M u),  u = a (a . (x - x_c)):  sqrt(E/rho) of a bar            (2)
// a solid has 10 m/s (soft rubber) to 15 km/s (diamond as a structure with joints and masses stays below); l: 1 mm to
// 1 km; and where all nodes lie on a line, with EA = u^T K u / l and EI from bending it to a constant curvature about
// both axes, the density in the solid rectangle of these stiffnesses,
//   rho = m / (12 l sqrt(EI_1 EI_2) / EA)                                                            (3)
// 0.1 kg/m3 (lattice booms and thin tubes as lines) to 25000. A wrong unit of mass alone changes no frequency: it is
// detected by (3) or the box around the nodes only if it exceeds their limits. (2): Timoshenko 1974, section 5.1.
#pragma once

#include <string_view>

#include "flex/fe_model.h"

namespace slew::flex {

enum class ModelUnits : int { m_kg_s, mm_t_s, mm_kg_ms, mm_kg_s, in_lbf_s, ft_lbf_s };
inline constexpr std::string_view kUnitNames[] = {"m_kg_s", "mm_t_s", "mm_kg_ms", "mm_kg_s", "in_lbf_s", "ft_lbf_s"};

// Applies (1) in place.
void to_si(ModelUnits units, FeModel& model);

// Throws InputError for a model in SI that is no solid by (2), (3) or its length, with the matching units.
// Pre-condition: its mass is positive. stated: units in the description, for the message.
void judge_units(const FeModel& model, ModelUnits stated);

}  // namespace slew::flex
