// SPDX-License-Identifier: Apache-2.0
// Which flexible bodies have a static equilibrium at the start, by groups of bodies that joints, gears, force elements
// or touching contacts connect. Ground connects no groups.
//
// A group with a loop, a gear, or a segmented body of which joints hold more than its root is held: its bodies start
// undeformed here (welded_start.h; modes in loops: loop_rest.h). A group that nothing connects to Ground falls: gravity
// strains none of its bodies, and they start undeformed. A straight start that the scene selects for a segmented body
// is that of all. All others start at rest (settle_segments(), settle_modes()). Internal to the library.
#pragma once

#include <vector>

#include "multibody/model/model.h"

namespace slew::multibody {

enum class StartRest : unsigned char { computed, given, held, falls };

// given: segmented bodies alone
struct StartGroups {
  std::vector<StartRest> parts;      // by Model::parts
  std::vector<StartRest> segmented;  // by Model::segmented
};

// From the start of the model. Allocates.
[[nodiscard]] StartGroups find_start_groups(const Model& model);

}  // namespace slew::multibody
