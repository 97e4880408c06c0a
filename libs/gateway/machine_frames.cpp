// SPDX-License-Identifier: Apache-2.0
#include "gateway/machine_frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

#include "gateway/body_shapes.h"
#include "gateway/server_messages.h"
#include "multibody/model/defs.h"

namespace slew::gateway {
namespace {

using math::Mat3;
using math::Quaternion;
using math::Vec3;

constexpr const char* kPoseParts[] = {".position.x",    ".position.y",    ".position.z",   ".orientation.w",
                                      ".orientation.x", ".orientation.y", ".orientation.z"};
constexpr Color kGroundColor = {0.55, 0.55, 0.52}, kTubeColor = {0.25, 0.27, 0.30}, kRodColor = {0.80, 0.82, 0.84};
constexpr Color kBodyColors[] = {{0.90, 0.62, 0.14}, {0.20, 0.45, 0.70}, {0.72, 0.30, 0.22}, {0.35, 0.60, 0.40}};
constexpr double kTubePart = 0.95;     // length of tube and rod over the shortest length of the cylinder
constexpr double kUnstatedPart = 0.6;  // the same over its present length
constexpr double kTubeRadius = 0.05, kRodRadius = 0.025;  // over the shortest length
constexpr double kStarThickness = 0.012;                  // over the size of the machine

const Color& color_of(std::size_t body) {
  return body == 0 ? kGroundColor : kBodyColors[body % std::size(kBodyColors)];
}

// World has x to the right, z up against gravity (along y without gravity).
Quaternion ground_in_world(const Triple& gravity) {
  const double g = math::norm(Vec3(gravity));
  const Vec3 up = g > 0 ? (-1 / g) * Vec3(gravity) : Vec3(0, 1, 0);
  const Vec3 aside = std::fabs(up[0]) < 0.9 ? Vec3(1, 0, 0) : Vec3(0, 0, 1);
  const Vec3 level = aside - math::dot(aside, up) * up;
  const Vec3 right = (1 / math::norm(level)) * level;
  const Mat3 R_GW(right, math::cross(up, right), up);
  const Quaternion q = math::quaternion_of(R_GW);
  return {q.w, -q.x, -q.y, -q.z};
}

// The orientation whose z axis has a direction.
Quaternion orientation_along(Vec3 direction) {
  const Vec3 z = (1 / math::norm(direction)) * direction;
  const Vec3 aside = std::fabs(z[0]) < 0.9 ? Vec3(1, 0, 0) : Vec3(0, 1, 0);
  const Vec3 across = math::cross(z, aside);
  const Vec3 y = (1 / math::norm(across)) * across;
  return math::quaternion_of(Mat3(math::cross(y, z), y, z));
}

void put_transform(const std::string& time, const char* parent, const std::string& child, Vec3 p, const Quaternion& q,
                   std::string& message) {
  if (message.back() == '}') message += ',';
  fmt::format_to(std::back_inserter(message),
                 R"({{"timestamp":{},"parent_frame_id":"{}","child_frame_id":{},)"
                 R"("translation":{{"x":{},"y":{},"z":{}}},"rotation":{{"x":{},"y":{},"z":{},"w":{}}}}})",
                 time, parent, Json(child).dump(), p.x(), p.y(), p.z(), q.x, q.y, q.z, q.w);
}

Json entity(const std::string& name, const std::string& frame, std::uint64_t time_ns, const Json& shapes) {
  Json json = {{"timestamp", time_json(time_ns)}, {"frame_id", frame},     {"id", name},
               {"lifetime", time_json(0)},        {"frame_locked", true},  {"metadata", Json::array()},
               {"arrows", Json::array()},         {"texts", Json::array()}};
  for (const char* kind : {"cubes", "spheres", "cylinders", "lines", "triangles", "models"}) {
    const Json* list = shapes.find(kind);
    json[kind] = list != nullptr ? *list : Json::array();
  }
  return json;
}

// Points of a body at which joints and forces act, for a body without shapes.
struct Star {
  Vec3 hub;
  bool has_hub = false;
  bool has_shapes = false, has_graphics = false;
  std::vector<Vec3> points;
};

double size_of(const multibody::MechanicsDef& mechanics, const std::vector<Star>& stars) {
  double size = 0;
  for (const multibody::BodyDef& body : mechanics.bodies) size = std::max(size, math::norm(Vec3(body.position)));
  for (const Star& star : stars) {
    for (const Vec3& point : star.points) size = std::max(size, math::norm(point));
  }
  return size > 0 ? size : 1;
}

}  // namespace

std::string asset_name(const scene::GraphicDef& graphic) {
  return graphic.name + ".glb";
}

std::string_view asset_of_uri(std::string_view uri) noexcept {
  return uri.starts_with(kAssetScheme) ? uri.substr(kAssetScheme.size()) : std::string_view();
}

MachineFrames::MachineFrames(const scene::Scene& scene, const Assets& assets)
    : q_WG_(ground_in_world(scene.mechanics.gravity)) {
  const multibody::MechanicsDef& mechanics = scene.mechanics;
  std::map<std::string, std::size_t> index = {{"Ground", 0}};
  bodies_.push_back({"Ground"});
  for (const multibody::BodyDef& body : mechanics.bodies) {
    index.emplace(body.name, bodies_.size());
    bodies_.push_back({body.name});
  }
  std::vector<Star> stars(bodies_.size());
  for (const multibody::JointDef& joint : mechanics.joints) {
    if (const auto body1 = index.find(joint.body1); body1 != index.end())
      stars[body1->second].points.emplace_back(joint.point1);
    const auto body2 = index.find(joint.body2);
    if (body2 == index.end()) continue;
    Star& carried = stars[body2->second];
    carried.points.emplace_back(joint.point2);
    if (!std::exchange(carried.has_hub, true)) carried.hub = Vec3(joint.point2);
  }
  for (const multibody::TranslationalForceDef& force : mechanics.translational_forces) {
    if (index.contains(force.body1)) stars[index.at(force.body1)].points.emplace_back(force.point1);
    if (index.contains(force.body2)) stars[index.at(force.body2)].points.emplace_back(force.point2);
  }
  add_graphics(scene, assets);
  for (std::size_t i = 0; i < bodies_.size(); ++i) stars[i].has_graphics = bodies_[i].shapes.find("models") != nullptr;
  for (const multibody::ShapeDef& shape : mechanics.shapes) {
    const auto body = index.find(shape.body);
    if (body == index.end() || stars[body->second].has_graphics) continue;
    stars[body->second].has_shapes = true;
    add_shape(shape, color_of(body->second), bodies_[body->second].shapes);
  }
  size_ = size_of(mechanics, stars);
  for (std::size_t i = 1; i < bodies_.size(); ++i) {
    if (stars[i].has_shapes || stars[i].has_graphics) continue;
    stars[i].points.emplace_back(mechanics.bodies[i - 1].center_of_mass);
    add_star(stars[i].hub, stars[i].points, kStarThickness * size_, color_of(i), bodies_[i].shapes);
  }
  add_cylinders(scene);
}

void MachineFrames::add_graphics(const scene::Scene& scene, const Assets& assets) {
  for (const scene::GraphicDef& graphic : scene.graphics) {
    const std::string name = asset_name(graphic);
    const auto body = std::ranges::find(bodies_, graphic.body, &Body::name);
    if (body == bodies_.end() || !assets.contains(name)) continue;
    add_model(std::string(kAssetScheme) + name, Vec3(graphic.position),
              math::quaternion_of(math::rotation_zxz(graphic.orientation)), body->shapes);
  }
}

void MachineFrames::add_cylinders(const scene::Scene& scene) {
  const auto index_of = [&](const std::string& name) {
    return static_cast<std::size_t>(std::ranges::find(bodies_, name, &Body::name) - bodies_.begin());
  };
  for (const scene::PortDef& port : scene.ports) {
    const auto& forces = scene.mechanics.translational_forces;
    const auto force = std::ranges::find(forces, port.force, &multibody::TranslationalForceDef::name);
    if (force == forces.end()) continue;
    const Cylinder cylinder = {port.name,           index_of(force->body1), index_of(force->body2),
                               Vec3(force->point1), Vec3(force->point2),    force->min_length};
    if (cylinder.body1 < bodies_.size() && cylinder.body2 < bodies_.size()) cylinders_.push_back(cylinder);
  }
}

void MachineFrames::find_places(const observer::SessionView& view) {
  has_frames_ = false;
  for (std::size_t i = 1; i < bodies_.size(); ++i) {
    Body& body = bodies_[i];
    body.is_found = true;
    for (std::size_t k = 0; k < body.pose.size(); ++k) {
      const observer::VariablePlace* const place = view.find_place(body.name + kPoseParts[k]);
      if (place != nullptr) body.pose[k] = *place;
      body.is_found = body.is_found && place != nullptr;
    }
    has_frames_ = has_frames_ || body.is_found;
  }
}

std::optional<MachineFrames::Pose> MachineFrames::pose(const Body& body, const StepSnapshot& snapshot) const noexcept {
  if (&body == &bodies_.front()) return Pose{};
  if (!body.is_found) return std::nullopt;
  std::array<double, 7> v{};
  for (std::size_t k = 0; k < v.size(); ++k) {
    v[k] = snapshot.value(body.pose[k]);
    if (!std::isfinite(v[k])) return std::nullopt;
  }
  return Pose{Vec3(v[0], v[1], v[2]), Quaternion{v[3], v[4], v[5], v[6]}};
}

void MachineFrames::encode_transforms(const StepSnapshot& snapshot, std::uint64_t time_ns, std::string& message) const {
  const std::string time = time_json(time_ns).dump();
  message += R"({"transforms":[)";
  put_transform(time, "World", "Ground", Vec3(), q_WG_, message);
  for (std::size_t i = 1; i < bodies_.size(); ++i) {
    if (const auto pose_of_body = pose(bodies_[i], snapshot))
      put_transform(time, "Ground", bodies_[i].name, pose_of_body->p_WB, pose_of_body->q_WB, message);
  }
  for (const Cylinder& cylinder : cylinders_) put_cylinder(cylinder, snapshot, time, message);
  message += "]}";
}

void MachineFrames::put_cylinder(const Cylinder& cylinder, const StepSnapshot& snapshot, const std::string& time,
                                 std::string& message) const {
  const auto pose1 = pose(bodies_[cylinder.body1], snapshot), pose2 = pose(bodies_[cylinder.body2], snapshot);
  if (!pose1 || !pose2) return;
  const Vec3 eye1 = pose1->p_WB + math::rotation_of(pose1->q_WB) * cylinder.point1;
  const Vec3 eye2 = pose2->p_WB + math::rotation_of(pose2->q_WB) * cylinder.point2;
  if (!(math::norm(eye2 - eye1) > 0)) return;
  put_transform(time, "Ground", cylinder.name + "/tube", eye1, orientation_along(eye2 - eye1), message);
  put_transform(time, "Ground", cylinder.name + "/rod", eye2, orientation_along(eye1 - eye2), message);
}

void MachineFrames::add_cylinder_entities(const Cylinder& cylinder, const StepSnapshot& snapshot, std::uint64_t time_ns,
                                          Json& entities) const {
  double length = kTubePart * cylinder.shortest;
  if (length == 0) {
    const auto pose1 = pose(bodies_[cylinder.body1], snapshot), pose2 = pose(bodies_[cylinder.body2], snapshot);
    if (!pose1 || !pose2) return;
    const Vec3 eye1 = pose1->p_WB + math::rotation_of(pose1->q_WB) * cylinder.point1;
    const Vec3 eye2 = pose2->p_WB + math::rotation_of(pose2->q_WB) * cylinder.point2;
    length = kUnstatedPart * math::norm(eye2 - eye1);
  }
  for (const bool is_tube : {true, false}) {
    Json shapes = Json::object();
    add_cylinder((is_tube ? kTubeRadius : kRodRadius) * length, length, length / 2, is_tube ? kTubeColor : kRodColor,
                 shapes);
    const std::string name = cylinder.name + (is_tube ? "/tube" : "/rod");
    entities.push_back(entity(name, name, time_ns, shapes));
  }
}

std::string MachineFrames::scene_update(const StepSnapshot& snapshot, std::uint64_t time_ns) const {
  Json entities = Json::array();
  for (const Body& body : bodies_) entities.push_back(entity(body.name, body.name, time_ns, body.shapes));
  for (const Cylinder& cylinder : cylinders_) add_cylinder_entities(cylinder, snapshot, time_ns, entities);
  return Json({{"deletions", Json::array()}, {"entities", std::move(entities)}}).dump();
}

}  // namespace slew::gateway
