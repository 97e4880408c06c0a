// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/index.h"
#include "multibody/constraints/constraint.h"
#include "multibody/model/field_tables.h"
#include "multibody/results/observe.h"

namespace slew::multibody {
namespace {

std::string name_of(JointType type) {
  if (type == JointType::node) return "node";
  return std::string(sections()[1].types[static_cast<std::size_t>(type)].name);
}

std::string describe(const Model& model, const FlexiblePart& part) {
  const auto omega = [&](std::size_t k) {
    const std::size_t own = k * part.modes + k;
    return std::sqrt(part.stiffness[own] / part.mass_matrix[own]);
  };
  std::string nodes;
  for (const Joint& joint : model.joints) {
    const bool is_its_own = joint.type == JointType::node && joint.name.starts_with(part.name + ".");
    if (is_its_own) nodes += (nodes.empty() ? "" : ", ") + joint.name;
  }
  if (part.modes == 0) return fmt::format("{}: no mode of '{}', rigid", part.name, part.source->source);
  return fmt::format("{}: {} of '{}', {:.4g} to {:.4g} rad/s by themselves, {}; nodes in use: {}", part.name,
                     part.modes == 1 ? "1 mode" : fmt::format("{} modes", part.modes), part.source->source, omega(0),
                     omega(part.modes - 1),
                     part.is_shortening() ? "with geometric stiffening" : "without geometric stiffening (no buckling)",
                     nodes.empty() ? "none" : nodes);
}

std::string describe(const SegmentedPart& part) {
  const SegmentChain& chain = *part.source;
  const std::size_t n = chain.connectors.size();
  return fmt::format("{}: {} of '{}', {:.4g} m each, {} lumps", part.name,
                     n == 1 ? "1 segment" : fmt::format("{} segments", n), chain.source, chain.connectors[0].length,
                     chain.lumps.size());
}

// Lumps and nodes of segmented bodies: bodies and joints that the scene does not have.
bool is_of_segments(const Model& model, const std::string& name) {
  return std::any_of(model.segmented.begin(), model.segmented.end(),
                     [&](const SegmentedPart& part) { return name.starts_with(part.name + "."); });
}

}  // namespace

Description describe(const Model& model) {
  Description text;
  // nodes are links of their own, but no bodies or joints of the scene
  const int nodes = static_cast<int>(std::count_if(model.joints.begin(), model.joints.end(),
                                                   [](const Joint& j) { return j.type == JointType::node; }));
  const auto lumps = static_cast<int>(std::count_if(
      model.bodies.begin(), model.bodies.end(), [&](const Body& body) { return is_of_segments(model, body.name); }));
  const auto holds = static_cast<int>(std::count_if(
      model.joints.begin(), model.joints.end(), [&](const Joint& joint) { return is_of_segments(model, joint.name); }));
  text.bodies = static_cast<int>(model.bodies.size()) - 1 - nodes - lumps;
  text.joints = static_cast<int>(model.joints.size()) - nodes - holds;
  text.degrees_of_freedom = model.degrees_of_freedom();
  text.rows = model.row_count();
  if (model.contact != nullptr) {
    for (const ContactPairElement& pair : model.contact->pairs) {
      (pair.tested < 0 ? text.pairs_at_rest : text.pairs).push_back(pair.name);
    }
  }
  text.links.resize(model.links.size() - 1);
  for (const Joint& joint : model.joints) {
    if (joint.link == 0) continue;
    LinkDescription& link = text.links[static_cast<std::size_t>(joint.link) - 1];
    link.joint = joint.name;
    link.joint_type = name_of(joint.type);
  }
  for (std::size_t i = 0; i < text.links.size(); ++i) {
    text.links[i].degrees_of_freedom = speed_count(model.links[i + 1].joint);
    if (text.links[i].joint.empty()) text.links[i].joint_type = "free";
  }
  for (const Drive& drive : model.drives) {
    const std::string& joint = model.joints[static_cast<std::size_t>(drive.joint)].name;
    text.driven.push_back(drive.name + " (" + joint + (drive.is_angle ? ", angle)" : ", displacement)"));
    if (drive.link > 0) --text.links[static_cast<std::size_t>(drive.link) - 1].degrees_of_freedom;
  }
  for (const std::vector<Gear>* gears : {&model.gears, &model.idle_gears}) {
    for (const Gear& gear : *gears) {
      text.gears.push_back(fmt::format("{} ({}, {})", gear.name, model.joints[at(gear.ends[0].joint)].name,
                                       model.joints[at(gear.ends[1].joint)].name));
    }
  }
  for (const Gear& gear : model.idle_gears) text.idle_gears.push_back(gear.name);
  for (const FlexiblePart& part : model.parts) text.flexible.push_back(describe(model, part));
  for (const SegmentedPart& part : model.segmented) text.flexible.push_back(describe(part));
  for (const Cut& cut : model.cuts) {
    const Joint& joint = model.joints[static_cast<std::size_t>(cut.joint)];
    CutDescription& entry = text.cuts.emplace_back();
    entry.joint = joint.name;
    entry.joint_type = name_of(joint.type);
    entry.rows = static_cast<int>(cut.rows.size());
    for (std::size_t k = 0; k < cut.redundant.size(); ++k) {
      entry.redundant.push_back("row " + std::to_string(cut.left_out[k] + 1) + " (" + describe(cut.redundant[k]) + ")");
    }
  }
  for (std::size_t i = 1; i < model.bodies.size(); ++i) {
    const Body& body = model.bodies[i];
    if (body.link == 0) {
      text.fixed_to_ground.push_back(body.name);
    } else {
      text.links[static_cast<std::size_t>(body.link) - 1].bodies.push_back(body.name);
    }
  }
  return text;
}

}  // namespace slew::multibody
