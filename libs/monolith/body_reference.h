// SPDX-License-Identifier: Apache-2.0
// Mechanics alone in body coordinates under IDA: the second reference beside the one in joint coordinates.
//
// Every link has its own coordinates q (position, quaternion) and speeds u; joints are rows with the multipliers lambda
// and mu (body_coordinates.h, constraint.h),
//   q' = rates(q, u + G^T mu)
//   M u' + G^T lambda = Q(q, u),   g(q) = 0,   G u = 0                                                (1)
// the stabilised form of index 2 of Gear, Leimkuhler and Gupta 1985: positions and speeds stay on the joints by
// themselves, and mu stays at the size of the error. There is no projection and no restart. Bristles of joints are
// variables of their own. This reference shares the laws of the elements and the rows with the other one; coordinates,
// equations, linear algebra and solver differ.
//
// Not covered: contacts, and singular positions, in which (1) has no unique multipliers: IDA then gives up.
#pragma once

#include "monolith/mechanics_reference.h"

namespace slew::monolith {

// integrate_mechanics() with ReferenceEquations::body_coordinates; result.model is built.
[[nodiscard]] Status integrate_bodies(std::span<const double> times, const MechanicsReferenceOptions& options,
                                      MechanicsReference& result);

}  // namespace slew::monolith
