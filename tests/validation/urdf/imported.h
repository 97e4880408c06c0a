// SPDX-License-Identifier: Apache-2.0
// A URDF text as the mechanism of the scene that is made of it.
#pragma once

#include <string>

#include "scene/ports.h"
#include "scene/scene.h"
#include "tests/unit/scene/temporary_folder.h"
#include "tests/validation/multibody/mechanism.h"
#include "urdf/import.h"

namespace slew::urdf::testing {

inline scene::Scene imported_scene(const std::string& urdf, RootMount mount = RootMount::fixed) {
  const scene::TemporaryFolder folder;
  return scene::load_text(import_file(folder.write("robot.urdf", urdf), mount).text, "imported");
}

struct Imported {
  explicit Imported(const std::string& urdf, RootMount mount = RootMount::fixed)
      : scene(imported_scene(urdf, mount)), mechanism(scene.mechanics, scene::row_names(scene)) {}

  [[nodiscard]] const multibody::BodyDef& body(const std::string& name) const {
    for (const auto& one : scene.mechanics.bodies) {
      if (one.name == name) return one;
    }
    throw std::out_of_range(name);
  }
  [[nodiscard]] const multibody::JointDef& joint(const std::string& name) const {
    for (const auto& one : scene.mechanics.joints) {
      if (one.name == name) return one;
    }
    throw std::out_of_range(name);
  }
  // u' of the mechanism at the coordinates and speeds, with the forces of the rows
  std::vector<double> accelerations(const std::vector<double>& q, const std::vector<double>& u,
                                    const std::vector<double>& row_forces = {}) {
    multibody::forward_dynamics(mechanism.model, q, u, row_forces, mechanism.ws);
    return mechanism.ws.udot;
  }

  scene::Scene scene;
  multibody::testing::Mechanism mechanism;
};

}  // namespace slew::urdf::testing
