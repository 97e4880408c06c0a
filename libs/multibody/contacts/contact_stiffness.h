// SPDX-License-Identifier: Apache-2.0
// Stiffness and damping of contacts over the speeds of the links (link_stiffness.h). Internal to the library.
//
// For the points i of one pair, with depths d, shares w = d/S, S = sum d, and normal forces F(w, d): along their
// normals
//   dF_i/dd_j = delta_ij (w_i f_i' + F_i/d_i) - F_i/S,   F_i = w_i f_i                                       (1)
// the second part made symmetric as c F F^T, with the c that keeps a motion of all points together exact, or a smaller
// one that keeps (1) positive semi-definite. Across the normals the symmetric part of the friction's slopes, positive
// semi-definite as well. The dependence of friction on the normal force is neglected.
#pragma once

#include "multibody/formulations/link_stiffness.h"

namespace slew::multibody {

// After update_contacts() at an instant after the start of the sub-step.
void add_contact_stiffness(const Model& model, const Workspace& ws, ChangeWeights weights, LinkMatrix& matrix) noexcept;

}  // namespace slew::multibody
