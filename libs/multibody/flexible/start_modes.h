// SPDX-License-Identifier: Apache-2.0
// Modal coordinates at the start. Internal to the library.
#pragma once

#include <vector>

#include "multibody/model/model.h"

namespace slew::multibody {

// Static equilibrium, in the start pose of the joints, of flexible bodies without a given start: modal coordinates at
// which gravity, the springs of the mechanism and the point loads of time zero, all joints held, balance the modes,
//   q <- q + K^-1 (Q - dV/dq),   V the potential energy, Q the generalised forces of the loads            (1)
// with the stiffness K of each body, which settles while the springs on the bodies are softer than these; else
//   q <- q + (d2V/dq2)^-1 (Q - dV/dq)                                                                     (2)
// Row forces are not in it. Bodies that are not selected keep their start. False: neither settles, as beyond a buckling
// load; the modes start at zero. selected: by Model::parts.
[[nodiscard]] bool settle_modes(Model& model, const std::vector<bool>& selected);

}  // namespace slew::multibody
