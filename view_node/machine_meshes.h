// SPDX-License-Identifier: Apache-2.0
// The meshes for the eye of a scene, read for the clients of a window.
#pragma once

#include <cstddef>
#include <string>

#include "gateway/machine_frames.h"
#include "scene/scene.h"

namespace slew::view_node {

inline constexpr std::size_t kMostMeshBytes = 512u << 20;  // of all meshes of a machine

struct MachineMeshes {
  gateway::Assets assets;
  std::string problem;  // how many are left out, and the reason for the first; empty: none
};

// folder: of the scene's files.
[[nodiscard]] MachineMeshes read_machine_meshes(const scene::Scene& scene, const std::string& folder);

}  // namespace slew::view_node
