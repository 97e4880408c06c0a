// SPDX-License-Identifier: Apache-2.0
#include "multibody/forces/build_elements.h"

#include <algorithm>

namespace slew::multibody {

using math::Mat3;
using math::Vec3;

namespace {

void add_part(const PartDummyDef& def, ElementBuilder& builder) {
  const Pose& frame = builder.pose_at(builder.number_of(def.relative_to));
  builder.add_mass(builder.number_of(def.carried_by), ElementBuilder::pose_in(frame, def.position, def.orientation),
                   def.mass, Vec3(def.center_of_mass), def.inertia);
}

void add_joint_part(const ConstraintDummyDef& def, const MechanicsDef& mechanics, ElementBuilder& builder) {
  const auto joint = std::find_if(mechanics.joints.begin(), mechanics.joints.end(),
                                  [&](const JointDef& candidate) { return candidate.name == def.relative_to; });
  const int body1 = builder.number_of(joint->body1), body2 = builder.number_of(joint->body2);
  const JointFrames frames = joint_frames(*joint, builder.pose_at(body1), builder.pose_at(body2));
  const bool is_first = def.index == 1;
  const Pose dummy = ElementBuilder::pose_in(is_first ? frames.frame1 : frames.frame2, def.position, def.orientation);
  builder.add_mass(is_first ? body1 : body2, dummy, def.mass, Vec3(def.center_of_mass), def.inertia);
}

}  // namespace

FramePair ElementBuilder::frames_of(const ConnectorFrames& def) const {
  const int body1 = number_of(def.body1), body2 = number_of(def.body2);
  return {.link1 = body_at(body1).link,
          .link2 = body_at(body2).link,
          .body1 = body1,
          .body2 = body2,
          .R_L1 = body_at(body1).R_LB * math::rotation_xyz(def.orientation1),
          .R_L2 = body_at(body2).R_LB * math::rotation_xyz(def.orientation2),
          .p_L1 = in_link(body1, def.point1),
          .p_L2 = in_link(body2, def.point2),
          .rest = {}};
}

Pose ElementBuilder::pose_in(const Pose& frame, const Triple& position, const Triple& orientation) {
  return {frame.R * math::rotation_zxz(orientation), frame.p + frame.R * Vec3(position)};
}

void ElementBuilder::add_mass(int number, const Pose& dummy, double mass, Vec3 center, const Triple& inertia) {
  const Body& body = body_at(number);
  const Pose& carrier = pose_at(number);
  const Mat3 R_LD = body.R_LB * (math::transpose(carrier.R) * dummy.R);
  const Vec3 p_LD = body.p_LB + body.R_LB * (math::transpose(carrier.R) * (dummy.p - carrier.p));
  const Mat3 I = Mat3::diagonal(inertia[0], inertia[1], inertia[2]);
  model_.lumped.push_back({.c_L = p_LD + R_LD * center,
                           .I_c = R_LD * I * math::transpose(R_LD),
                           .mass = mass,
                           .reference_mass = mass,
                           .link = body.link,
                           .owner = number});
}

void add_elements(const MechanicsDef& def, std::span<const Pose> poses, Model& model) {
  ElementBuilder builder(def, poses, model);
  for_each_force_type(def, [&](auto row, const auto& /*type*/, const auto& defs) {
    for (const auto& one : defs) elements_of(row, model.elements).push_back(row.build(one, builder));
  });
  for (const PartDummyDef& dummy : def.part_dummies) add_part(dummy, builder);
  for (const ConstraintDummyDef& dummy : def.constraint_dummies) add_joint_part(dummy, def, builder);
}

}  // namespace slew::multibody
