// SPDX-License-Identifier: Apache-2.0
#include "multibody/motions/drive_variables.h"

#include <cstddef>

#include "core/index.h"
#include "multibody/results/observe.h"

namespace slew::multibody {

using math::Vec3;

namespace {

// z of a joint's frame in Ground
Vec3 axis_of(const Model& model, const Workspace& ws, int body, const math::Mat3& R_BF) noexcept {
  const Body& holder = model.bodies[at(body)];
  return ws.motion[at(holder.link)].R * (holder.R_LB * R_BF.c[2]);
}

}  // namespace

void list_drives(const Model& model, std::vector<ElementVariable>& variables) {
  using enum Dimension;
  for (const Drive& drive : model.drives) {
    variables.push_back({drive.name + ".position", drive.is_angle ? angle : length});
    variables.push_back({drive.name + ".velocity", drive.is_angle ? angular_velocity : velocity});
    variables.push_back({drive.name + ".acceleration", drive.is_angle ? angular_acceleration : acceleration});
  }
}

void list_drive_forces(const Model& model, std::vector<ElementVariable>& variables) {
  for (const Drive& drive : model.drives) {
    variables.push_back(
        {drive.name + (drive.is_angle ? ".torque" : ".force"), drive.is_angle ? Dimension::torque : Dimension::force});
    variables.push_back({drive.name + ".power", Dimension::power});
  }
}

double drive_force(const Model& model, const Workspace& ws, std::size_t index, std::span<const double> row_forces,
                   std::span<const JointReaction> reactions) noexcept {
  const Drive& drive = model.drives[index];
  const Joint& joint = model.joints[at(drive.joint)];
  const bool is_second_turn = joint.type == JointType::universal && drive.number == 1;
  const Vec3 axis =
      is_second_turn ? axis_of(model, ws, joint.body2, joint.R_B2) : axis_of(model, ws, joint.body1, joint.R_B1);
  // the reaction acts on body 1, the drive on body 2
  const JointReaction& reaction = reactions[at(drive.joint)];
  double force = -dot(axis, Vec3(drive.is_angle ? reaction.moment : reaction.force));
  for (std::size_t k = 0; k < row_forces.size(); ++k) {
    const Row& row = model.rows[k];
    if (row.kind == RowKind::joint && row.element == drive.joint && row.number == drive.number) force -= row_forces[k];
  }
  for (std::size_t k = 0; k < model.gears.size(); ++k) {
    for (std::size_t end = 0; end < 2; ++end) {
      if (model.gears[k].ends[end].joint == drive.joint) force -= gear_force(model, ws, k, end);
    }
  }
  return force;
}

}  // namespace slew::multibody
