// SPDX-License-Identifier: Apache-2.0
// Problems of flexible bodies before the model is built. Internal to the library.
#pragma once

#include <string>

#include "core/problem.h"
#include "multibody/model/defs.h"

namespace slew::multibody {

// Checked: that the files of every flexible or segmented body were read, that its numbers by mode are as many as its
// modes. False: with_nodes() cannot take the mechanics.
[[nodiscard]] bool check_flexible_bodies(const MechanicsDef& mechanics, Problems& problems);

// "1 to 20", the nodes of the flexible body in a node's name `name`; empty if it names none.
[[nodiscard]] std::string nodes_beside(const MechanicsDef& mechanics, const std::string& name);

// Checks for modes too fast for an explicit integrator's sub-steps, held by the mechanism at the start. Pre-condition:
// nothing else is wrong.
void check_mode_speeds(const MechanicsDef& mechanics, Problems& problems);
// The same for bodies of finite segments.
void check_segment_speeds(const MechanicsDef& mechanics, Problems& problems);

}  // namespace slew::multibody
