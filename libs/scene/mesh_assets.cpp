// SPDX-License-Identifier: Apache-2.0
#include "scene/mesh_assets.h"

#include <cmath>
#include <limits>
#include <utility>

#include "contact/mesh_check.h"
#include "contact/mesh_file/mesh_file.h"
#include "scene/assets.h"

namespace slew::scene {
namespace {

using multibody::ShapeDef;

// faults of the shape's keys, checked before the file is read
bool is_complete(const LoadContext& load_context, const ShapeDef& shape, Problems& problems) {
  const std::size_t before = problems.size();
  const auto add = [&](const char* key, std::string what, std::string expected) {
    problems.push_back({shape.name + "." + key, std::move(what), std::move(expected), ""});
  };
  if (shape.file.empty()) {
    if (shape.vertices.empty()) add("file", "there is no mesh", "a file, or vertices and triangles");
    if (std::isfinite(shape.file_unit)) add("unit", "it has no effect without a file", "a file");
    if (!shape.file_up.empty()) add("up", "it has no effect without a file", "a file");
    return false;
  }
  if (!shape.vertices.empty()) add("vertices", "the shape has a file already", "either a file or vertices");
  if (!load_context.has_folder) add("file", "a scene without a folder cannot read a file", "vertices and triangles");
  if (auto refusal = load_context.refusal_of(shape.file)) {
    add("file", std::move(refusal->what), std::move(refusal->expected));
  }
  if (!std::isfinite(shape.file_unit))
    add("unit", "the unit of the file is missing", "the length of one unit, such as '1 mm'");
  if (shape.file_up != "y" && shape.file_up != "z") {
    add("up", shape.file_up.empty() ? "the axis that points up is missing" : "'" + shape.file_up + "' is no such axis",
        "y or z");
  }
  return problems.size() == before;
}

}  // namespace

void put_mesh(const contact::MeshDef& mesh, ShapeDef& shape) {
  for (const Triple& vertex : mesh.vertices) shape.vertices.insert(shape.vertices.end(), vertex.begin(), vertex.end());
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t vertex : triangle) shape.triangles.push_back(vertex);
  }
  shape.file.clear();
  shape.file_up.clear();
  shape.file_unit = std::numeric_limits<double>::infinity();
}

void read_meshes(const LoadContext& load_context, multibody::MechanicsDef& mechanics, Problems& problems) {
  for (ShapeDef& shape : mechanics.shapes) {
    const bool is_mesh =
        shape.type == contact::ShapeType::convex_mesh || shape.type == contact::ShapeType::triangle_mesh;
    if (!is_mesh || !is_complete(load_context, shape, problems)) continue;
    Problems found;
    const contact::MeshDef mesh =
        contact::read_mesh(shape.name,
                           {.path = load_context.path_of(shape.file),
                            .unit = shape.file_unit,
                            .up_in_file = shape.file_up == "y" ? contact::UpAxis::y : contact::UpAxis::z,
                            .up = contact::UpAxis::y},
                           found);
    for (Problem& problem : found) {
      problem.path = shape.name + ".file";
      problems.push_back(std::move(problem));
    }
    if (!found.empty()) continue;
    const bool is_convex = shape.type == contact::ShapeType::convex_mesh;
    if (const auto fault = is_convex ? contact::find_convex_fault(mesh) : contact::find_touched_fault(mesh)) {
      problems.push_back({shape.name + ".file", fault->what, fault->expected, ""});
    } else {
      put_mesh(mesh, shape);
    }
  }
}

}  // namespace slew::scene
