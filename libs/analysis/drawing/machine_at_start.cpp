// SPDX-License-Identifier: Apache-2.0
#include "analysis/drawing/machine_at_start.h"

#include "multibody/model/model.h"
#include "multibody/model/state.h"
#include "multibody/results/observe.h"
#include "scene/ports.h"

namespace slew::analysis {

MachineAtStart::MachineAtStart(const scene::Scene& scene) {
  const multibody::Model model = multibody::build_model(scene.mechanics, scene::row_names(scene));
  const multibody::State state = multibody::start_state(model);
  multibody::Workspace ws(model);
  multibody::observe(model, state, ws);
  index_.emplace(multibody::kGroundName, 0);
  bodies_.push_back({math::Vec3(), math::rotation_x(0)});
  for (const multibody::BodyDef& body : scene.mechanics.bodies) {
    index_.emplace(body.name, bodies_.size());
    const multibody::BodyPose pose = multibody::body_pose(model, ws, static_cast<int>(bodies_.size()));
    const auto& [w, x, y, z] = pose.orientation;
    bodies_.push_back({math::Vec3(pose.position), math::rotation_of({w, x, y, z})});
  }
}

std::optional<std::size_t> MachineAtStart::index(const std::string& body) const {
  const auto found = index_.find(body);
  return found == index_.end() ? std::nullopt : std::optional(found->second);
}

std::optional<math::Vec3> MachineAtStart::point(const std::string& body, const Triple& position) const {
  const auto found = index(body);
  if (!found) return std::nullopt;
  return bodies_[*found].p_WB + bodies_[*found].R_WB * math::Vec3(position);
}

}  // namespace slew::analysis
