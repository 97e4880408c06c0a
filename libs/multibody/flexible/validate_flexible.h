// What is wrong with flexible bodies before anything is built of them. Internal to the library.
#pragma once

#include <string>

#include "core/problem.h"
#include "multibody/model/defs.h"

namespace slew::multibody {

// Checked: that the files of every flexible or segmented body were read, that its numbers by mode are as many as its
// modes. False: with_nodes() cannot take the mechanics.
[[nodiscard]] bool check_flexible_bodies(const MechanicsDef& mechanics, Problems& problems);

// "1 to 20" of the flexible body whose node `name` pretends to be; empty when it names none.
[[nodiscard]] std::string nodes_beside(const MechanicsDef& mechanics, const std::string& name);

// Modes that an explicit integrator cannot follow in its sub-steps as the mechanism holds them at the start.
// Pre-condition: nothing else is wrong.
void check_mode_speeds(const MechanicsDef& mechanics, Problems& problems);
// The same of bodies of finite segments.
void check_segment_speeds(const MechanicsDef& mechanics, Problems& problems);

}  // namespace slew::multibody
