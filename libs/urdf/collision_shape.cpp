// SPDX-License-Identifier: Apache-2.0
#include "urdf/collision_shape.h"

#include <fmt/format.h>

#include <optional>
#include <string_view>
#include <system_error>

#include "contact/mesh_check.h"
#include "contact/mesh_file/mesh_file.h"
#include "scene/assets.h"

namespace slew::urdf {
namespace {

namespace fs = std::filesystem;
using contact::ShapeType;

constexpr std::string_view kPackage = "package://", kFile = "file://";

bool is_there(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

// The file named by a URDF; empty: it does not exist.
fs::path find_file(const std::string& name, const fs::path& folder) {
  const std::string_view text = name;
  if (text.starts_with(kFile)) return is_there(text.substr(kFile.size())) ? text.substr(kFile.size()) : fs::path();
  if (!text.starts_with(kPackage)) return is_there(folder / name) ? folder / name : fs::path();
  const std::string_view in_package = text.substr(kPackage.size());
  const std::size_t slash = in_package.find('/');
  if (slash == std::string_view::npos) return {};
  const fs::path path = in_package.substr(slash + 1);
  std::error_code error;
  fs::path above = fs::absolute(folder, error).lexically_normal();
  while (!error) {
    if (is_there(above / path)) return above / path;
    if (above == above.parent_path()) break;
    above = above.parent_path();
  }
  return {};
}

// name of a file relative to a scene in that folder; empty: it lies elsewhere
std::string name_inside(const fs::path& file, const fs::path& folder) {
  std::error_code error;
  const fs::path base = fs::canonical(folder.empty() ? fs::path(".") : folder, error);
  const std::string name = fs::canonical(file, error).lexically_relative(base).generic_string();
  return !base.empty() && scene::is_inside_folder(name) ? name : std::string();
}

void take_mesh(const Geometry& geometry, bool is_static, const Folders& folders, CollisionShape& shape) {
  const auto [x, y, z] = geometry.scale;
  if (!(x > 0 && x == y && y == z)) {
    shape.refusal = "its scale is not one positive number";
    return;
  }
  const fs::path file = find_file(geometry.file, folders.robot);
  if (file.empty()) {
    shape.refusal = "there is no such file";
    return;
  }
  shape.def.file = name_inside(file, folders.scene);
  if (shape.def.file.empty()) {
    shape.refusal = fmt::format("'{}' is not in the scene's folder", file.lexically_normal().string());
    return;
  }
  shape.def.file_unit = x;
  shape.def.file_up = "y";  // the file's y is the shape's y
  Problems problems;
  shape.mesh = contact::read_mesh(
      "", {.path = file, .unit = x, .up_in_file = contact::UpAxis::y, .up = contact::UpAxis::y}, problems);
  if (!problems.empty()) {
    shape.refusal = problems.front().what;
    return;
  }
  shape.def.type = ShapeType::convex_mesh;
  const auto dents = contact::find_convex_fault(shape.mesh);
  if (!dents) return;
  shape.refusal = dents->what;
  if (!is_static || contact::find_touched_fault(shape.mesh)) return;
  shape.def.type = ShapeType::triangle_mesh;
  shape.refusal.clear();
}

}  // namespace

CollisionShape collision_shape(const Geometry& geometry, const Pose& in_body, bool is_static, const Folders& folders) {
  CollisionShape shape;
  const Pose pose = in_body * pose_of(geometry.origin);
  shape.def.position = position_of(pose);
  shape.def.orientation = orientation_of(pose);
  shape.def.radius = geometry.radius;
  shape.def.length = geometry.length;
  shape.def.size = geometry.size;
  switch (geometry.kind) {
    case Geometry::Kind::box:
      shape.def.type = ShapeType::box;
      break;
    case Geometry::Kind::sphere:
      shape.def.type = ShapeType::sphere;
      break;
    case Geometry::Kind::cylinder:
      shape.def.type = ShapeType::cylinder;
      break;
    case Geometry::Kind::capsule:
      shape.def.type = ShapeType::capsule;
      break;
    case Geometry::Kind::mesh:
      take_mesh(geometry, is_static, folders, shape);
      break;
  }
  return shape;
}

}  // namespace slew::urdf
