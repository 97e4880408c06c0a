// What must hold of joints, spring-dampers and force dummies in the poses that a scene starts from. Internal to the
// library: validate.cpp calls it.
#pragma once

#include <span>
#include <vector>

#include "core/problem.h"
#include "multibody/model/defs.h"
#include "multibody/model/topology.h"

namespace slew::multibody {

// Frames of joints, their limits, lengths of massless links and forces, neighbours of dummies. poses: of all bodies;
// all names are known.
void check_start(const MechanicsDef& mechanics, std::span<const Pose> poses, const std::vector<TreeEdge>& tree,
                 Problems& problems);

}  // namespace slew::multibody
