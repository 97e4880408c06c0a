// SPDX-License-Identifier: Apache-2.0
// From the Defs of force kinds and dummies to the model's arrays. Internal to the library.
#pragma once

#include <span>
#include <string>

#include "multibody/model/model.h"
#include "multibody/model/topology.h"

namespace slew::multibody {

// The model whose bodies are placed, as a row's build() reads and extends it.
class ElementBuilder {
 public:
  // poses: of all bodies at the start.
  ElementBuilder(const MechanicsDef& def, std::span<const Pose> poses, Model& model)
      : number_of_(def), poses_(poses), model_(model) {}

  [[nodiscard]] int number_of(const std::string& body) const { return number_of_(body); }
  [[nodiscard]] const Body& body_at(int number) const { return model_.bodies[static_cast<std::size_t>(number)]; }
  [[nodiscard]] const Pose& pose_at(int number) const { return poses_[static_cast<std::size_t>(number)]; }
  // A point of a body, in the body's link [m].
  [[nodiscard]] math::Vec3 in_link(int number, const Triple& point) const {
    return body_at(number).p_LB + body_at(number).R_LB * math::Vec3(point);
  }
  [[nodiscard]] FramePair frames_of(const ConnectorFrames& def) const;
  // A dummy's frame in Ground, from the frame that its Def refers to; orientation: Euler z-x'-z''.
  [[nodiscard]] static Pose pose_in(const Pose& frame, const Triple& position, const Triple& orientation);
  // A mass with this pose in Ground, fixed to the body's link as the start poses have it; center and inertia in the
  // dummy's frame.
  void add_mass(int number, const Pose& dummy, double mass, math::Vec3 center, const Triple& inertia);

 private:
  BodyNumbers number_of_;
  std::span<const Pose> poses_;
  Model& model_;
};

// Appends elements and lumped masses to a model whose bodies are placed. poses: of all bodies at the start.
void add_elements(const MechanicsDef& def, std::span<const Pose> poses, Model& model);

}  // namespace slew::multibody
