// SPDX-License-Identifier: Apache-2.0
#include "sensors/shape_search.h"

#include <algorithm>
#include <cstdint>

#include "contact/find_named.h"
#include "contact/mesh_check.h"
#include "contact/solid.h"
#include "math/rotation.h"

namespace slew::sensors {

using contact::ShapeDef;
using contact::ShapeType;
using fcl_border::QueryResult;
using math::Mat3;
using math::Vec3;

namespace {

bool is_zone(const SensorsDef& def, const std::string& shape) {
  return std::any_of(def.sensors.begin(), def.sensors.end(), [&](const SensorDef& s) { return s.zone == shape; });
}

std::size_t frame_index(const SensorsDef& def, const std::string& name) {
  return static_cast<std::size_t>(contact::find_named(def.frames, name) - def.frames.data());
}

std::size_t add_shape(fcl_border::Geometries& geometries, const ShapeDef& def, const contact::Geometry& geometry) {
  std::vector<double> vertices;
  for (const Vec3& v : geometry.vertices) vertices.insert(vertices.end(), {v[0], v[1], v[2]});
  const std::uint32_t* triangles = geometry.triangles.empty() ? nullptr : geometry.triangles.front().data();
  switch (def.type) {
    case ShapeType::sphere:
      return add_sphere(geometries, def.radius);
    case ShapeType::box:
      return add_box(geometries, def.size[0], def.size[1], def.size[2]);
    case ShapeType::cylinder:
      return add_cylinder(geometries, def.radius, def.length);
    case ShapeType::capsule:
      return add_capsule(geometries, def.radius, def.length);
    case ShapeType::plane:
      return add_plane(geometries);
    case ShapeType::convex_mesh:
      return add_convex(geometries, vertices.data(), geometry.vertices.size(), triangles, geometry.triangles.size());
    case ShapeType::triangle_mesh:
    case ShapeType::height_field:
      break;
  }
  return add_surface(geometries, vertices.data(), geometry.vertices.size(), triangles, geometry.triangles.size());
}

Vec3 vector(const double* x) {
  return {x[0], x[1], x[2]};
}

}  // namespace

std::vector<std::size_t> shapes_of(const SensorsDef& def, const std::vector<std::string>& names) {
  std::vector<std::size_t> found;
  for (const std::string& name : names) {
    for (std::size_t i = 0; i < def.shapes.size(); ++i) {
      const ShapeDef& shape = def.shapes[i];
      if (shape.name != name && (shape.frame != name || is_zone(def, shape.name))) continue;
      if (std::find(found.begin(), found.end(), i) == found.end()) found.push_back(i);
    }
  }
  return found;
}

Sensors::Search::Search(const SensorsDef& def)
    : geometries(fcl_border::create_geometries(), &free_geometries), groups(nullptr, &free_groups) {
  for (const ShapeDef& shape : def.shapes) {
    const contact::Geometry geometry = contact::make_geometry(shape);
    const Vec3 p_FS(shape.position);
    const Mat3 R_FS = math::rotation_zxz(shape.orientation);
    shapes.push_back({add_shape(*geometries, shape, geometry), frame_index(def, shape.frame), p_FS, R_FS,
                      norm(p_FS + R_FS * geometry.centre) + geometry.bounding_radius});
  }
  groups.reset(fcl_border::create_groups(*geometries));
}

std::size_t Sensors::Search::add_group(const std::vector<std::size_t>& members) {
  std::vector<std::size_t> indices, frames;
  for (const std::size_t i : members) indices.push_back(shapes[i].geometry), frames.push_back(shapes[i].frame);
  group_shapes.push_back(members);
  return fcl_border::add_group(*groups, indices.data(), frames.data(), indices.size());
}

bool Sensors::Search::find_nearest(std::size_t a, std::size_t b, Nearest& found) {
  fcl_border::Nearest raw{};
  if (fcl_border::find_nearest(*groups, a, b, raw) != QueryResult::fine) return false;
  found = {raw.distance,
           vector(raw.p_a_W),
           vector(raw.p_b_W),
           vector(raw.n_W),
           shapes[group_shapes[a][raw.member_a]].frame,
           shapes[group_shapes[b][raw.member_b]].frame};
  return true;
}

}  // namespace slew::sensors
