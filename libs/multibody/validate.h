// Everything that is wrong with the mechanics of a scene, found before anything is built.
//
// Checked: names, masses, inertia (triangle rule, positive definite), directions, limits, that the joints form a tree
// rooted in Ground, that the frames of every joint agree at the start, that dummies sit on forces between neighbours.
// Ranges of single numbers are the field tables' matter and checked here as well, so that a Def made in code is safe.
#pragma once

#include "core/problem.h"
#include "multibody/defs.h"

namespace slew::multibody {

// Appends to problems; nothing is appended for a sound Def. Paths are "Element.key".
void validate(const MechanicsDef& mechanics, Problems& problems);

}  // namespace slew::multibody
