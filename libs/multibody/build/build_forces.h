// SPDX-License-Identifier: Apache-2.0
// Parts of build_model(): force elements, and dummies. Internal to the library.
#pragma once

#include <span>

#include "multibody/model/model.h"
#include "multibody/model/topology.h"

namespace slew::multibody {

// link_poses: in Ground at the start, by link.
void add_forces(const MechanicsDef& mechanics, std::span<const Pose> link_poses, Model& model);

// Masses of static and force dummies; after add_forces().
void add_dummies(const MechanicsDef& mechanics, Model& model);

}  // namespace slew::multibody
