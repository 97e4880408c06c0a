// SPDX-License-Identifier: Apache-2.0
// Rules of prescribed motion. Internal to the library: validate.cpp calls them.
#pragma once

#include <span>

#include "core/problem.h"
#include "multibody/model/defs.h"
#include "multibody/model/topology.h"

namespace slew::multibody {

// Rules that need no poses. False when a joint is unknown or has no such coordinate: starts then cannot be looked at.
[[nodiscard]] bool check_motions(const MechanicsDef& mechanics, Problems& problems);

// Motions begin where the poses have their joint, within the assembly's tolerance, and with its speed when one is
// given. poses: of all bodies; all names are known.
void check_motion_starts(const MechanicsDef& mechanics, std::span<const Pose> poses, Problems& problems);

}  // namespace slew::multibody
