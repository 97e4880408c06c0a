// SPDX-License-Identifier: Apache-2.0
// Detection of singular joints: a part without inertia about a free axis. Internal to the library.
#pragma once

#include "core/problem.h"
#include "multibody/model/defs.h"

namespace slew::multibody {

// Pre-condition: the Def is sound otherwise. Checks the start position.
void find_singular_joints(const MechanicsDef& mechanics, Problems& problems);

}  // namespace slew::multibody
