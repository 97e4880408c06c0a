// SPDX-License-Identifier: Apache-2.0
#include "view_node/machine_meshes.h"

#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <utility>

#include "scene/assets.h"

namespace slew::view_node {

MachineMeshes read_machine_meshes(const scene::Scene& scene, const std::string& folder) {
  MachineMeshes meshes;
  std::size_t bytes = 0, left_out = 0;
  const auto leave_out = [&](const scene::GraphicDef& graphic, const std::string& reason) {
    if (left_out++ == 0) meshes.problem = graphic.name + ": " + reason;
  };
  for (const scene::GraphicDef& graphic : scene.graphics) {
    // the scene may come from another machine
    if (const auto refusal = scene::LoadContext{true, folder}.refusal_of(graphic.file)) {
      leave_out(graphic, refusal->what);
      continue;
    }
    Problems problems;
    std::string glb = scene::graphic_as_glb(graphic, (std::filesystem::path(folder) / graphic.file).string(), problems);
    if (!problems.empty()) {
      leave_out(graphic, problems.front().what);
    } else if (bytes + glb.size() > kMostMeshBytes) {
      leave_out(graphic, fmt::format("the meshes have more than {} bytes together", kMostMeshBytes));
    } else {
      bytes += glb.size();
      meshes.assets.emplace(gateway::asset_name(graphic), std::make_shared<const std::string>(std::move(glb)));
    }
  }
  if (left_out > 0) {
    meshes.problem = fmt::format(
        "{} of {} meshes are left out and their bodies drawn by their shapes; the first is {}; "
        "name the folder of the scene's files with --assets",
        left_out, scene.graphics.size(), meshes.problem);
  }
  return meshes;
}

}  // namespace slew::view_node
