// Rules of gears. Internal to the library: validate.cpp calls them.
#pragma once

#include <span>
#include <vector>

#include "core/problem.h"
#include "multibody/model/defs.h"
#include "multibody/model/topology.h"

namespace slew::multibody {

// Both joints are there and have one coordinate, of the kind that the gear's type says. False otherwise: starts then
// cannot be looked at.
[[nodiscard]] bool check_gears(const MechanicsDef& mechanics, Problems& problems);

// Both joints belong to the tree, and their start positions fit the gear within the assembly's tolerance. poses: of all
// bodies; all names are known.
void check_gear_starts(const MechanicsDef& mechanics, std::span<const Pose> poses, const std::vector<TreeEdge>& tree,
                       Problems& problems);

}  // namespace slew::multibody
