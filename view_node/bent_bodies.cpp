// SPDX-License-Identifier: Apache-2.0
#include "view_node/bent_bodies.h"

#include <exception>

#include "flex/reduction.h"

namespace slew::view_node {
namespace {

constexpr std::size_t kMostNodes = 500;  // of a body: each point of a mesh looks for its nearest ones

}  // namespace

Json bent_bodies_json(const scene::Scene& scene, const std::string& text, const std::string& folder) {
  Json bodies = Json::array();
  if (scene.mechanics.flexible_bodies.empty()) return bodies;
  try {
    const scene::Scene whole = scene::load_text(text, scene.name, {}, folder);
    for (const scene::FlexibleBody& body : whole.flexible_bodies) {
      if (body.reduction->body.nodes.size() > kMostNodes) continue;
      Json nodes = Json::array();
      for (const flex::ReducedNode& node : body.reduction->body.nodes)
        nodes.push_back({{"id", node.id}, {"position", Json(node.position.array())}});
      bodies.push_back({{"body", body.body}, {"nodes", std::move(nodes)}});
    }
  } catch (const std::exception&) {
    return Json::array();  // another folder, or another version of the files
  }
  return bodies;
}

}  // namespace slew::view_node
