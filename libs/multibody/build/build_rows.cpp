// SPDX-License-Identifier: Apache-2.0
#include "multibody/build/build_rows.h"

#include <array>
#include <cstddef>
#include <tuple>
#include <utility>

#include "core/check.h"
#include "core/index.h"
#include "multibody/joints/joint_axes.h"
#include "multibody/model/topology.h"

namespace slew::multibody {
namespace {

// appends all links between those given and Ground, outermost first; returns where they begin and end
std::pair<int, int> add_support(Model& model, std::span<const int> links) {
  std::vector<bool> is_reached(model.links.size(), false);
  for (int link : links) {
    for (; link > 0; link = model.links[at(link)].parent) is_reached[at(link)] = true;
  }
  const int first = static_cast<int>(model.supports.size());
  for (std::size_t link = is_reached.size(); link-- > 1;) {
    if (is_reached[link]) model.supports.push_back(static_cast<int>(link));
  }
  return {first, static_cast<int>(model.supports.size())};
}

Row length_row(Model& model, std::size_t line) {
  Row row{.kind = RowKind::length, .element = static_cast<int>(line)};
  row.first_path = static_cast<int>(model.paths.size());
  add_path(model, model.lines[line].link1, model.lines[line].link2);
  row.path_end = static_cast<int>(model.paths.size());
  return row;
}

Row angle_row(const Model& model, std::size_t angle) {
  return {.kind = RowKind::angle,
          .element = static_cast<int>(angle),
          .first_path = model.angles[angle].first_path,
          .path_end = model.angles[angle].path_end};
}

Row joint_row(const JointDef& joint_def, std::size_t joint, int number, Model& model) {
  const bool is_ball = joint_def.type == JointType::spherical;
  const JointAxisDef def = axis_of(joint_def, is_ball ? 0 : number);
  Row row{.kind = is_ball ? RowKind::ball : RowKind::joint,
          .element = static_cast<int>(joint),
          .link = model.joints[joint].link,
          .number = number};
  // a universal joint that the tree walks backwards has its coordinates in the other order
  row.place = joint_def.type == JointType::universal && model.joints[joint].is_reversed ? 1 - number : number;
  row.first_path = static_cast<int>(model.paths.size());
  if (is_ball) {
    const Joint& ball = model.joints[joint];
    add_path(model, model.bodies[at(ball.body1)].link, model.bodies[at(ball.body2)].link);
  } else if (row.link > 0) {
    model.paths.push_back({.link = row.link, .sign = 1});
  } else {
    const Cut& cut = model.cuts[at(model.joints[joint].cut)];
    add_path(model, cut.link1, cut.link2);
  }
  row.path_end = static_cast<int>(model.paths.size());
  row.law = {.coulomb = def.coulomb_friction,
             .viscous = def.viscous_friction,
             .friction_speed = def.friction_speed,
             .bristle_stiffness = def.bristle_stiffness,
             .bristle_damping = def.bristle_damping,
             .breakaway_ratio = def.breakaway_ratio,
             .limit_min = def.limit_min,
             .limit_max = def.limit_max,
             .limit_stiffness = def.limit_stiffness,
             .limit_damping = def.limit_damping};
  return row;
}

}  // namespace

void add_path(Model& model, int link1, int link2) {
  while (link1 != link2) {
    // a parent has the smaller number, so the larger one is no ancestor of the other
    int& deeper = link1 > link2 ? link1 : link2;
    const double sign = link1 > link2 ? -1 : 1;
    model.paths.push_back({.link = deeper, .sign = sign});
    deeper = model.links[at(deeper)].parent;
  }
}

void add_supports(Model& model, Gear& gear) {
  std::tie(gear.first_support, gear.support_end) = add_support(model, std::array{gear.ends[0].link, gear.ends[1].link});
}

void add_supports(Model& model, Cut& cut) {
  std::tie(cut.first_support, cut.support_end) = add_support(model, std::array{cut.link1, cut.link2});
}

void add_row(const MechanicsDef& mechanics, const std::string& name, Model& model) {
  Row row;
  for (std::size_t i = 0; i < model.lines.size(); ++i) {
    if (model.lines[i].name == name) row = length_row(model, i);
  }
  for (std::size_t i = 0; i < model.angles.size(); ++i) {
    if (model.angles[i].name == name) row = angle_row(model, i);
  }
  for (std::size_t i = 0; i < mechanics.joints.size(); ++i) {
    for (int number = 0; number < row_count(mechanics.joints[i].type); ++number) {
      if (row_label(mechanics.joints[i], number) == name) row = joint_row(mechanics.joints[i], i, number, model);
    }
  }
  row.name = name;
  SLEW_CHECK(row.path_end > row.first_path);
  std::vector<int> moved;
  for (int i = row.first_path; i < row.path_end; ++i) moved.push_back(model.paths[at(i)].link);
  std::tie(row.first_support, row.support_end) = add_support(model, moved);
  model.rows.push_back(row);
}

std::vector<std::string> joint_rows(const MechanicsDef& mechanics) {
  std::vector<std::string> names;
  for (const JointDef& joint : mechanics.joints) {
    for (int number = 0; number < row_count(joint.type); ++number) {
      if (has_row(joint, number)) names.push_back(row_label(joint, number));
    }
  }
  return names;
}

void validate_rows(const MechanicsDef& mechanics, std::span<const std::string> rows, Problems& problems) {
  Problems ignored;
  const std::vector<int> merged = merged_into(mechanics, find_tree(mechanics, ignored));
  const auto is_merged = [&](const std::string& body1, const std::string& body2) {
    const int a = find_body(mechanics, body1), b = find_body(mechanics, body2);
    return a == kNoBody || b == kNoBody || merged[at(a)] == merged[at(b)];
  };
  for (const std::string& name : rows) {
    bool is_known = false, is_rigid = false;
    for (const TranslationalForceDef& force : mechanics.translational_forces) {
      if (force.name == name) is_known = true, is_rigid = is_merged(force.body1, force.body2);
    }
    for (const RotationalForceDef& force : mechanics.rotational_forces) {
      if (force.name == name) is_known = true, is_rigid = is_merged(force.body1, force.body2);
    }
    for (const JointDef& joint : mechanics.joints) {
      for (int number = 0; number < row_count(joint.type); ++number) is_known |= row_label(joint, number) == name;
    }
    if (!is_known) {
      problems.push_back({name,
                          "nothing can act here: '" + name + "' is no force and no joint with one coordinate",
                          "a translational or rotational force, or a revolute or prismatic joint",
                          {}});
    } else if (is_rigid) {
      problems.push_back({name, "the force acts between bodies that fixed joints merge", "bodies that can move", {}});
    }
  }
}

}  // namespace slew::multibody
