// SPDX-License-Identifier: Apache-2.0
// Rules for joints, spring-dampers and force dummies in the start poses of a scene. Internal to the library:
// validate.cpp calls it.
#pragma once

#include <span>
#include <vector>

#include "core/problem.h"
#include "multibody/model/defs.h"
#include "multibody/model/topology.h"

namespace slew::multibody {

// Frames of joints, their limits, lengths of massless links and forces, neighbours of dummies. poses: those of all
// bodies; all names exist.
void check_start(const MechanicsDef& mechanics, std::span<const Pose> poses, const std::vector<TreeEdge>& tree,
                 Problems& problems);

}  // namespace slew::multibody
