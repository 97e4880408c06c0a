// Rules of the elements and dummies of element_defs.h. Internal to the library: validate.cpp calls them.
#pragma once

#include <span>

#include "core/problem.h"
#include "multibody/model/defs.h"
#include "multibody/model/topology.h"

namespace slew::multibody {

// Calls visit(defs, section, type) for every list of element_defs.h; section and type index sections().
template <typename Visit>
void for_each_element_list(const MechanicsDef& m, Visit&& visit) {
  visit(m.point_forces, 2, 2);
  visit(m.point_torques, 2, 3);
  visit(m.bushings, 2, 4);
  visit(m.beams, 2, 5);
  visit(m.ropes, 2, 6);
  visit(m.tyre_dummies, 3, 2);
  visit(m.part_dummies, 3, 3);
  visit(m.constraint_dummies, 3, 4);
}

// Rules that need no poses. False when a name is that of nothing: poses then cannot be looked at.
[[nodiscard]] bool check_elements(const MechanicsDef& mechanics, Problems& problems);

// Rules of the start. poses: of all bodies; all names are known.
void check_element_starts(const MechanicsDef& mechanics, std::span<const Pose> poses, Problems& problems);

// Tables of a spring or a damper at `path`: two points or more, increasing; a damper's pass through [0, 0] and never
// drive. An empty table is none.
enum class TableUse : std::uint8_t { any, spring, damper, rope_spring };
void check_table(const std::string& path, const Table& table, TableUse use, Problems& problems);

}  // namespace slew::multibody
