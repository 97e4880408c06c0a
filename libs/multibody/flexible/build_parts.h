// SPDX-License-Identifier: Apache-2.0
// The flexible parts and nodes of a model. Internal to the library.
#pragma once

#include "multibody/model/defs.h"
#include "multibody/model/model.h"

namespace slew::multibody {

// The node held by the body's joint of the type `node`, for the frames at the start.
[[nodiscard]] FlexibleNode build_node(const MechanicsDef& mechanics, const JointDef& joint, const Body& flexible);

// Appends the parts with their coordinates, after the bodies and joints; nodes are bound to them. Start coordinates are
// those of the scene or zero.
void add_parts(const MechanicsDef& mechanics, Model& model);

}  // namespace slew::multibody
