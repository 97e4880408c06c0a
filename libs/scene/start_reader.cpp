// SPDX-License-Identifier: Apache-2.0
#include "scene/start_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "core/suggestion.h"
#include "multibody/build/put_joints.h"
#include "multibody/joints/joint_axes.h"
#include "multibody/model/topology.h"
#include "scene/element_table.h"

namespace slew::scene {
namespace {

struct StartValue {
  double value = 0;
};

struct PayloadNames {
  std::vector<std::string> bodies;
};

class StartReader {
 public:
  StartReader(const multibody::MechanicsDef& mechanics, const ReadContext& context)
      : mechanics_(mechanics), context_(context) {}

  std::vector<multibody::StartCoordinate> read(const Node& start) {
    if (start.kind != Node::Kind::map) {
      report_problem(start.mark, std::string(kStartKey), "is " + describe(start),
                     "a map, such as {Boom_Hinge: 40 deg}");
      return {};
    }
    report_duplicates(start, std::string(kStartKey), context_.report);
    for (const Node::Entry& entry : start.entries) read_joint(entry);
    return std::move(coordinates_);
  }

 private:
  void report_problem(const Mark& mark, std::string path, std::string what, std::string expected,
                      std::string suggestion = "") {
    context_.report.add(mark, std::move(path), {std::move(what), std::move(expected), std::move(suggestion)});
  }

  void read_joint(const Node::Entry& entry) {
    const std::string path = fmt::format("{}.{}", kStartKey, entry.key);
    context_.places.add(path, entry.mark);
    const auto joint = std::find_if(mechanics_.joints.begin(), mechanics_.joints.end(),
                                    [&](const multibody::JointDef& def) { return def.name == entry.key; });
    if (joint == mechanics_.joints.end()) {
      std::vector<std::string_view> names;
      for (const multibody::JointDef& def : mechanics_.joints) names.push_back(def.name);
      report_problem(entry.mark, path, "no joint '" + entry.key + "'", "", closest(entry.key, names));
      return;
    }
    const int count = multibody::coordinate_count(joint->type);
    if (count == 0) {
      report_problem(entry.mark, path, "the joint has no coordinates",
                     "a revolute, prismatic, cylindrical or universal joint");
    } else if (count == 1) {
      read_value_of(*joint, 0, entry.value, path);
    } else if (entry.value.kind == Node::Kind::sequence && static_cast<int>(entry.value.items.size()) == count) {
      for (int number = 0; number < count; ++number) {
        read_value_of(*joint, number, entry.value.items[static_cast<std::size_t>(number)], path);
      }
    } else {
      report_problem(entry.value.mark, path, "is " + describe(entry.value),
                     fmt::format("a list of the joint's {} coordinates", count));
    }
  }

  void read_value_of(const multibody::JointDef& joint, int number, const Node& node, const std::string& path) {
    const Dimension dimension = multibody::is_angle(joint.type, number) ? Dimension::angle : Dimension::length;
    const Field row = field<&StartValue::value>("value", {.dimension = dimension});
    StartValue coordinate;
    const std::size_t problems = context_.report.size();
    read_value(node, row, &coordinate, path, context_);
    if (context_.report.size() == problems) coordinates_.push_back({joint.name, number, coordinate.value});
  }

  const multibody::MechanicsDef& mechanics_;
  const ReadContext& context_;
  std::vector<multibody::StartCoordinate> coordinates_;
};

}  // namespace

void read_start(const Node& start, Scene& scene, const ReadContext& context, Problems& problems) {
  const std::size_t known = context.report.size();
  const auto coordinates = StartReader(scene.mechanics, context).read(start);
  if (context.report.size() > known) return;
  for (const multibody::StartCoordinate& coordinate : coordinates) scene.started_joints.push_back(coordinate.joint);
  multibody::put_joints(scene.mechanics, coordinates, problems);
}

void read_payload(const Node& payload, Scene& scene, const ReadContext& context) {
  PayloadNames names;
  const Field row = field<&PayloadNames::bodies>("payload", {.reference = "body"});
  Node list;
  list.kind = Node::Kind::sequence;
  list.mark = payload.mark;
  if (payload.kind == Node::Kind::scalar) list.items.push_back(payload);
  const std::string path(kPayloadKey);
  const std::size_t known = context.report.size();
  read_value(payload.kind == Node::Kind::scalar ? list : payload, row, &names, path, context);
  if (context.report.size() > known || names.bodies.empty()) return;
  std::string& first = scene.mechanics.payload;
  if (!first.empty() && first != names.bodies.front()) {
    context.report.add(payload.mark, path, {"mechanics.payload names another body first", "one of the two keys", ""});
    return;
  }
  first = names.bodies.front();
  scene.other_payloads.assign(names.bodies.begin() + 1, names.bodies.end());
}

void check_payloads(const Scene& scene, Problems& problems) {
  const auto refuse = [&problems](std::string what, const char* expected) {
    problems.push_back({std::string(kPayloadKey), std::move(what), expected, ""});
  };
  Problems known;  // of the tree, reported elsewhere
  const std::vector<int> carrier =
      multibody::merged_into(scene.mechanics, multibody::find_tree(scene.mechanics, known));
  std::vector<std::string_view> names = {scene.mechanics.payload};
  for (const std::string& payload : scene.other_payloads) {
    const int number = multibody::find_body(scene.mechanics, payload);
    const bool is_rigid =
        number > 0 && scene.mechanics.bodies[static_cast<std::size_t>(number) - 1].type == multibody::BodyType::rigid;
    if (std::find(names.begin(), names.end(), payload) != names.end()) {
      refuse("'" + payload + "' is named twice", "each body once");
    } else if (!is_rigid) {
      refuse("'" + payload + "' is not a rigid body, whose mass could be changed",
             "the name of a rigid body that moves");
    } else if (carrier[static_cast<std::size_t>(number)] == multibody::kGround) {
      refuse("'" + payload + "' is fixed to Ground and does not move", "the name of a rigid body that moves");
    }
    names.push_back(payload);
  }
}

}  // namespace slew::scene
