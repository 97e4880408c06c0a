// SPDX-License-Identifier: Apache-2.0
// Rules of gears. Internal to the library: validate.cpp calls them.
#pragma once

#include <span>
#include <vector>

#include "core/problem.h"
#include "multibody/model/defs.h"
#include "multibody/model/topology.h"

namespace slew::multibody {

// Checks that both joints exist and have one coordinate of the kind of the gear's type, and that ratios round a circle
// of gears agree. False where joints are not right: starts then cannot be checked.
[[nodiscard]] bool check_gears(const MechanicsDef& mechanics, Problems& problems);

// Checks that both joints belong to the tree, and that their start positions fit the gear within the assembly's
// tolerance. poses: those of all bodies; all names exist.
void check_gear_starts(const MechanicsDef& mechanics, std::span<const Pose> poses, const std::vector<TreeEdge>& tree,
                       Problems& problems);

}  // namespace slew::multibody
