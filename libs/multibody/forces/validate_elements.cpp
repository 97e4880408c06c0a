// SPDX-License-Identifier: Apache-2.0
#include "multibody/forces/validate_elements.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace slew::multibody {

using math::Vec3;

namespace {

// printed inertias are rounded: share of the largest moment by which the triangle rule may fail
constexpr double kMatrixTolerance = 1e-6;

void check_part(const PartDummyDef& def, ElementRules& rules) {
  rules.check_body(def.name, "relative_to", def.relative_to);
  rules.check_body(def.name, "carried_by", def.carried_by);
  rules.check_inertia(def.name, def.inertia);
}

void check_joint_part(const ConstraintDummyDef& def, const MechanicsDef& mechanics, ElementRules& rules) {
  const auto joint = std::find_if(mechanics.joints.begin(), mechanics.joints.end(),
                                  [&](const JointDef& candidate) { return candidate.name == def.relative_to; });
  if (joint == mechanics.joints.end()) {
    rules.add_broken_reference(def.name + ".relative_to", fmt::format("there is no joint '{}'", def.relative_to),
                               "the name of a joint");
  } else if (joint->type == JointType::spherical_spherical || joint->type == JointType::revolute_spherical ||
             joint->type == JointType::revolute_revolute) {
    rules.add(def.name + ".relative_to", fmt::format("'{}' is a massless link between its bodies", def.relative_to),
              "a joint with its frames on the bodies; give a link with mass a body of its own");
  }
  rules.check_inertia(def.name, def.inertia);
}

}  // namespace

bool ElementRules::check_body(const std::string& owner, std::string_view key, const std::string& body) {
  if (number_of_(body) != kNoBody) return true;
  add_broken_reference(fmt::format("{}.{}", owner, key), fmt::format("there is no body '{}'", body),
                       "the name of a body, or Ground");
  return false;
}

void ElementRules::check_direction(const std::string& path, const Triple& direction) {
  if (norm(Vec3(direction)) > 0) return;
  add(path, "the direction is zero", "a direction");
}

void ElementRules::check_connector(const std::string& name, const ConnectorFrames& frames) {
  const bool is_first_known = check_body(name, "body1", frames.body1);
  const bool is_known = check_body(name, "body2", frames.body2) && is_first_known;
  if (!is_known || frames.body1 != frames.body2) return;
  add_broken_reference(name + ".body2", fmt::format("both bodies are '{}'", frames.body1), "two different bodies");
}

void ElementRules::check_inertia(const std::string& name, Triple I) {
  std::sort(I.begin(), I.end());
  if (I[0] + I[1] >= I[2] * (1 - kMatrixTolerance)) return;
  add(name + ".inertia", fmt::format("moments {}, {}, {} kg m2 break the triangle rule", I[0], I[1], I[2]),
      "no moment larger than the sum of the other two");
}

Deflection ElementStartRules::deflection(const ConnectorFrames& def) const {
  LinkMotion link1, link2;
  link1.R = pose_of(def.body1).R;
  link1.p = pose_of(def.body1).p;
  link2.R = pose_of(def.body2).R;
  link2.p = pose_of(def.body2).p;
  FramePair pair;
  pair.R_L1 = math::rotation_xyz(def.orientation1);
  pair.R_L2 = math::rotation_xyz(def.orientation2);
  pair.p_L1 = Vec3(def.point1);
  pair.p_L2 = Vec3(def.point2);
  return deflection_of(pair, link1, link2);
}

bool check_elements(const MechanicsDef& mechanics, Problems& problems) {
  ElementRules rules(mechanics, problems);
  for_each_force_type(mechanics, [&](auto row, const auto& /*type*/, const auto& defs) {
    for (const auto& def : defs) row.check(def, rules);
  });
  for (const PartDummyDef& def : mechanics.part_dummies) check_part(def, rules);
  for (const ConstraintDummyDef& def : mechanics.constraint_dummies) check_joint_part(def, mechanics, rules);
  return rules.names_hold();
}

void check_element_starts(const MechanicsDef& mechanics, std::span<const Pose> poses, Problems& problems) {
  ElementStartRules rules(mechanics, poses, problems);
  for_each_force_type(mechanics, [&](auto row, const auto& /*type*/, const auto& defs) {
    for (const auto& def : defs) row.check_start(def, rules);
  });
}

void check_table(const std::string& path, const Table& table, TableUse use, Problems& problems) {
  if (table.empty()) return;
  const auto add = [&](std::string what, std::string expected) {
    problems.push_back({path, std::move(what), std::move(expected), {}});
  };
  if (table.size() < 2) return add("the table has one point", "two points or more");
  for (std::size_t i = 1; i < table.size(); ++i) {
    if (!(table[i][0] > table[i - 1][0])) return add("the arguments do not increase", "increasing arguments");
  }
  if (use == TableUse::rope_spring && (table[0][0] != 0 || table[0][1] != 0)) {
    return add("a rope's table begins elsewhere than at [0, 0]", "tension over stretch, from [0, 0] on");
  }
  if (use != TableUse::damper) return;
  const bool has_rest = std::any_of(table.begin(), table.end(), [](const auto& p) { return p[0] == 0 && p[1] == 0; });
  const bool drives = std::any_of(table.begin(), table.end(), [](const auto& p) { return p[0] * p[1] < 0; });
  if (drives) return add("the damper drives: a force has the sign against its speed", "forces with their speed's sign");
  if (!has_rest) add("the damper's table has no point [0, 0]", "a point [0, 0]: no force at rest");
}

}  // namespace slew::multibody
