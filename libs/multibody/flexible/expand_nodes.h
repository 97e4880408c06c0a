// SPDX-License-Identifier: Apache-2.0
// Nodes of flexible bodies and lumps of segmented ones as bodies of their own. Internal to the library.
#pragma once

#include <string>

#include "multibody/model/defs.h"

namespace slew::multibody {

// "Truck_JibBoom.Node20".
[[nodiscard]] std::string node_name(const std::string& body, std::int64_t id);

// "Truck_JibBoom.Segment3"; of the root lump the body itself.
[[nodiscard]] std::string lump_name(const SegmentedBodyDef& segmented, std::size_t lump);

// The same mechanics with, for every node of a flexible body at which something is attached, a massless body and a
// joint of the type `node` that holds it; references to the flexible body at a point then refer to the nearest node,
// and references by name to the named node. Attachments at the root and at other clamped nodes stay with the body, and
// where they are named the massless body is fixed to it. Flexible bodies have the mass and the inertia of their modes'
// source.
// Segmented bodies become rigid ones, their root lumps, and their other lumps are bodies, free of Ground where no joint
// of the scene holds them; references to such a body at a point then refer to the nearest lump, and used nodes are
// massless bodies fixed to the lump that holds them. Beams are added by add_segments(). Allocates.
[[nodiscard]] MechanicsDef with_nodes(const MechanicsDef& mechanics);

// True if with_nodes() changes the mechanics.
[[nodiscard]] inline bool has_parts(const MechanicsDef& mechanics) noexcept {
  return !mechanics.flexible_bodies.empty() || !mechanics.segmented_bodies.empty();
}

}  // namespace slew::multibody
