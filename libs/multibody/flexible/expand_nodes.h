// Nodes of flexible bodies as bodies of their own. Internal to the library.
#pragma once

#include <string>

#include "multibody/defs.h"

namespace slew::multibody {

// "Truck_JibBoom.Node20".
[[nodiscard]] std::string node_name(const std::string& body, std::int64_t id);

// The same mechanics with, for every node of a flexible body at which something is attached, a massless body and a
// joint of the type `node` that holds it; whatever referred to the flexible body at a point refers to the nearest node
// then, and what names a node to that. What is attached at the root stays with the body. Flexible bodies have the mass
// and the inertia of their modes' source. Allocates.
[[nodiscard]] MechanicsDef with_nodes(const MechanicsDef& mechanics);

}  // namespace slew::multibody
