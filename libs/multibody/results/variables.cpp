// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <array>
#include <cstddef>

#include "core/index.h"
#include "multibody/constraints/constraint.h"
#include "multibody/flexible/deflection.h"
#include "multibody/forces/element_law.h"
#include "multibody/formulations/passes.h"
#include "multibody/joints/joint_axes.h"
#include "multibody/motions/drive_variables.h"
#include "multibody/results/observe.h"

namespace slew::multibody {

using math::Mat3;
using math::Vec3;

namespace {

std::span<const double> modes_of(const FlexiblePart& part, std::span<const double> q) noexcept {
  return q.subspan(at(part.q), part.modes);
}

constexpr std::array<const char*, 3> kAxes = {".x", ".y", ".z"};

// value and rate of a joint's coordinate
RowValue read_coordinate(const Model& model, const State& state, const Workspace& ws, const Joint& joint, int number) {
  RowValue value;
  if (joint.cut >= 0) {
    const Cut& cut = model.cuts[at(joint.cut)];
    return coordinate(joint.type, number, cut, ws.motion[at(cut.link1)], ws.motion[at(cut.link2)]);
  }
  const Link& link = model.links[at(joint.link)];
  // a universal joint that the tree walks backwards has its coordinates in the other order
  const int place = joint.type == JointType::universal && joint.is_reversed ? 1 - number : number;
  value.g = state.q[at(link.q + place)];
  value.rate = state.u[at(link.u + place)];
  return value;
}

// force of the row that acts on an element or on a joint's coordinate; 0 without one
double row_force_on(const Model& model, RowKind kind, std::size_t element, std::span<const double> row_forces,
                    int number = 0) noexcept {
  double force = 0;
  for (std::size_t k = 0; k < row_forces.size(); ++k) {
    const Row& row = model.rows[k];
    if (row.kind == kind && at(row.element) == element && row.number == number) force += row_forces[k];
  }
  return force;
}

class Names {
 public:
  void add(const std::string& name, Dimension dimension) { list_.push_back({name, dimension}); }
  void add_triple(const std::string& name, Dimension dimension) {
    for (const char* axis : kAxes) add(name + axis, dimension);
  }
  [[nodiscard]] std::vector<ElementVariable>& list() { return list_; }
  [[nodiscard]] std::vector<ElementVariable> take() { return std::move(list_); }

 private:
  std::vector<ElementVariable> list_;
};

struct Values : VariableSink {
  using VariableSink::put;
  template <std::size_t N>
  void put(const std::array<double, N>& several) noexcept {
    for (const double value : several) put(value);
  }
};

}  // namespace

double deflection_share(const Model& model, std::size_t part, std::span<const double> q) noexcept {
  const FlexiblePart& flexible = model.parts[part];
  const double size = largest_deflection(*flexible.source, flexible.watched, modes_of(flexible, q)).size;
  return size > 0 ? size / flexible.length : 0;
}

double deflection_share(const Model& model, const SegmentedPart& part, const Workspace& ws) noexcept {
  return largest_deflection(model, part, ws).size / part.length;
}

bool is_bent_far(const Model& model, std::size_t part, std::span<const double> q) noexcept {
  return deflection_share(model, part, q) > kSmallDeflection;
}

bool is_bent_far(const Model& model, const SegmentedPart& part, const Workspace& ws) noexcept {
  return largest_bend(model, part, ws).angle > kLargestBend;
}

BodyPose body_pose(const Model& model, const Workspace& ws, int body) noexcept {
  const Body& b = model.bodies[at(body)];
  const LinkMotion& m = ws.motion[at(b.link)];
  const Mat3 R = m.R * b.R_LB;
  const Vec3 s = m.R * b.p_LB;
  const math::Quaternion attitude = math::quaternion_of(R);
  return {.position = (m.p + s).array(),
          .orientation = {attitude.w, attitude.x, attitude.y, attitude.z},
          .center_of_mass = (m.p + s + R * b.c_B).array(),
          .velocity = (m.v + cross(m.w, s)).array(),
          .angular_velocity = m.w.array()};
}

std::string_view joint_of(const Model& model, int state_index) noexcept {
  const int coordinates = model.coordinate_count();
  const bool is_coordinate = state_index < coordinates;
  int moved = 0;
  for (const FlexiblePart& part : model.parts) {
    const int index = is_coordinate ? state_index - part.q : state_index - coordinates - part.u;
    if (index >= 0 && index < static_cast<int>(part.modes)) return part.name;
  }
  for (std::size_t i = 1; i < model.links.size(); ++i) {
    const int first = is_coordinate ? model.links[i].q : model.links[i].u + coordinates;
    if (first <= state_index) moved = static_cast<int>(i);
  }
  for (const Joint& joint : model.joints) {
    if (joint.link == moved && moved > 0) return joint.name;
  }
  for (const Body& body : model.bodies) {
    if (body.link == moved && moved > 0) return body.name;
  }
  return "a joint";
}

std::vector<ElementVariable> variables(const Model& model) {
  using enum Dimension;
  Names names;
  for (std::size_t i = 1; i < model.bodies.size(); ++i) {
    const std::string& body = model.bodies[i].name;
    names.add_triple(body + ".position", length);
    for (const char* part : {".w", ".x", ".y", ".z"}) names.add(body + ".orientation" + part, none);
    names.add_triple(body + ".center_of_mass", length);
    names.add_triple(body + ".velocity", velocity);
    names.add_triple(body + ".angular_velocity", angular_velocity);
  }
  for (const FlexiblePart& part : model.parts) {
    names.add_triple(part.name + ".deflection", length);
    names.add(part.name + ".largest_deflection", length);
    for (std::size_t k = 1; k <= part.modes; ++k) {
      names.add(part.name + ".modal_coordinate_" + std::to_string(k), none);
      names.add(part.name + ".modal_velocity_" + std::to_string(k), none);
    }
  }
  for (const SegmentedPart& part : model.segmented) {
    names.add_triple(part.name + ".deflection", length);
    names.add(part.name + ".largest_deflection", length);
    names.add(part.name + ".strain_energy", Dimension::energy);
  }
  for (const Joint& joint : model.joints) {
    const int count = coordinate_count(joint.type);
    for (int number = 0; number < count; ++number) {
      const std::string suffix(suffix_of(joint.type, number));
      names.add(joint.name + ".position" + suffix, is_angle(joint.type, number) ? angle : length);
      names.add(joint.name + ".velocity" + suffix, is_angle(joint.type, number) ? angular_velocity : velocity);
    }
    if (joint.type == JointType::spherical) names.add_triple(joint.name + ".torque", torque);
    for (int number = 0; number < count; ++number) {
      if (!is_angle(joint.type, number)) {
        names.add(joint.name + ".force", force);
      } else {
        // for a cylindrical joint the dimension selects the coordinate
        const bool is_one_of_two = joint.type == JointType::universal;
        names.add(joint.name + ".torque" + (is_one_of_two ? std::string(suffix_of(joint.type, number)) : ""), torque);
      }
    }
  }
  for (const LineElement& line : model.lines) {
    names.add(line.name + ".length", length);
    names.add(line.name + ".rate", velocity);
    names.add(line.name + ".force", force);
  }
  for (const AngleElement& element : model.angles) {
    names.add(element.name + ".angle", angle);
    names.add(element.name + ".rate", angular_velocity);
    names.add(element.name + ".torque", torque);
  }
  list_variables(model.elements, names.list());
  list_drives(model, names.list());
  names.add("mechanics.kinetic_energy", Dimension::energy);
  names.add("mechanics.potential_energy", Dimension::energy);
  std::vector<ElementVariable> all = names.take();
  append_contact_variables(model, all);
  return all;
}

std::vector<ElementVariable> reaction_variables(const Model& model) {
  Names names;
  for (const Joint& joint : model.joints) {
    names.add_triple(joint.name + ".reaction_force", Dimension::force);
    names.add_triple(joint.name + ".reaction_moment", Dimension::torque);
  }
  for (const std::vector<Gear>* gears : {&model.gears, &model.idle_gears}) {
    for (const Gear& gear : *gears) {
      for (std::size_t end = 0; end < 2; ++end) {
        const bool is_torque = is_angle(gear.kind, end);
        names.add(fmt::format("{}.{}_{}", gear.name, is_torque ? "torque" : "force", end + 1),
                  is_torque ? Dimension::torque : Dimension::force);
      }
    }
  }
  list_drive_forces(model, names.list());
  return names.take();
}

void read_reactions(const Model& model, const Workspace& ws, std::span<const double> row_forces,
                    std::span<const JointReaction> reactions, std::span<double> values) noexcept {
  Values out{{values}};
  for (const JointReaction& reaction : reactions) {
    out.put(reaction.force);
    out.put(reaction.moment);
  }
  for (std::size_t k = 0; k < model.gears.size(); ++k) {
    for (std::size_t end = 0; end < 2; ++end) out.put(gear_force(model, ws, k, end));
  }
  // the others carry no force
  for (std::size_t k = 0; k < 2 * model.idle_gears.size(); ++k) out.put(0);
  for (std::size_t k = 0; k < model.drives.size(); ++k) {
    const double force = drive_force(model, ws, k, row_forces, reactions);
    out.put(force);
    out.put(force * ws.drives[k].speed);
  }
}

void read_variables(const Model& model, const State& state, const Workspace& ws, std::span<const double> row_forces,
                    std::span<double> values) noexcept {
  Values out{{values}};
  for (std::size_t i = 1; i < model.bodies.size(); ++i) {
    const BodyPose pose = body_pose(model, ws, static_cast<int>(i));
    out.put(pose.position);
    out.put(pose.orientation);
    out.put(pose.center_of_mass);
    out.put(pose.velocity);
    out.put(pose.angular_velocity);
  }
  for (const FlexiblePart& part : model.parts) {
    const std::span<const double> q = modes_of(part, state.q), u(state.u.data() + part.u, part.modes);
    out.put(deflection(part.source->nodes.back(), q).array());
    out.put(largest_deflection(*part.source, part.watched, q).size);
    for (std::size_t k = 0; k < part.modes; ++k) {
      out.put(q[k]);
      out.put(u[k]);
    }
  }
  for (const SegmentedPart& part : model.segmented) {
    out.put(tip_deflection(model, part, ws).array());
    out.put(largest_deflection(model, part, ws).size);
    out.put(strain_energy(model, part, ws));
  }
  for (std::size_t i = 0; i < model.joints.size(); ++i) {
    const Joint& joint = model.joints[i];
    const int count = coordinate_count(joint.type);
    for (int number = 0; number < count; ++number) {
      const RowValue value = read_coordinate(model, state, ws, joint, number);
      out.put(value.g);
      out.put(value.rate);
    }
    const RowKind kind = joint.type == JointType::spherical ? RowKind::ball : RowKind::joint;
    for (int number = 0; number < row_count(joint.type); ++number) {
      out.put(row_force_on(model, kind, i, row_forces, number));
    }
  }
  for (std::size_t i = 0; i < model.lines.size(); ++i) {
    const LineMotion& line = ws.lines[i];
    out.put(line.length);
    out.put(line.rate);
    out.put(force_of(model.lines[i].law, line.length, line.rate, line.rate) +
            row_force_on(model, RowKind::length, i, row_forces));
  }
  for (std::size_t i = 0; i < model.angles.size(); ++i) {
    const AngleMotion& angle = ws.angles[i];
    out.put(angle.angle);
    out.put(angle.rate);
    out.put(force_of(model.angles[i].law, angle.angle, angle.rate, damper_speed(model.angles[i], ws)) +
            row_force_on(model, RowKind::angle, i, row_forces));
  }
  read_variables(model.elements, ws.motion, ws.time, out);
  for (const MotionValue& value : ws.drives) {
    out.put(value.position);
    out.put(value.speed);
    out.put(value.acceleration);
  }
  const Energy sum = multibody::energy(model, ws);
  out.put(sum.kinetic);
  out.put(sum.potential);
  static_cast<void>(read_contact_variables(model, ws, out.rest()));
}

}  // namespace slew::multibody
