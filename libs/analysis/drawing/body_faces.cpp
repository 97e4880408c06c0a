// SPDX-License-Identifier: Apache-2.0
#include "analysis/drawing/body_faces.h"

#include <cmath>
#include <filesystem>
#include <functional>
#include <numbers>

#include "contact/mesh_file/mesh_file.h"
#include "math/rotation.h"
#include "scene/assets.h"

namespace slew::analysis {
namespace {

using contact::ShapeType;
using math::Vec3;

constexpr int kAround = 20, kHalfAround = 5;  // faces about a round shape, from its equator to a pole

// The faces between two rings of points about z, from low to high.
void add_band(const std::function<Vec3(int step, bool is_high)>& ring, std::vector<Face>& faces) {
  for (int i = 0; i < kAround; ++i) {
    const Vec3 a = ring(i, false), b = ring(i + 1, false), c = ring(i + 1, true), d = ring(i, true);
    faces.push_back({a, b, c});
    faces.push_back({a, c, d});
  }
}

Vec3 around(double radius, int step, double z) {
  const double angle = 2 * std::numbers::pi * step / kAround;
  return {radius * std::cos(angle), radius * std::sin(angle), z};
}

// Half of a sphere at z, towards +z or -z.
void add_dome(double radius, double z, double way, std::vector<Face>& faces) {
  for (int i = 0; i < kHalfAround; ++i) {
    const auto ring = [&](int step, bool is_high) {
      const bool is_outer = is_high == (way < 0);
      const double angle = std::numbers::pi / 2 * (i + (is_outer ? 0 : 1)) / kHalfAround;
      return around(radius * std::cos(angle), step, z + way * radius * std::sin(angle));
    };
    add_band(ring, faces);
  }
}

void add_cylinder_faces(double radius, double length, bool has_ends, std::vector<Face>& faces) {
  const double half = length / 2;
  add_band([&](int step, bool is_high) { return around(radius, step, is_high ? half : -half); }, faces);
  if (!has_ends) return;
  add_band([&](int step, bool is_high) { return around(is_high ? 0 : radius, step, half); }, faces);
  add_band([&](int step, bool is_high) { return around(is_high ? radius : 0, step, -half); }, faces);
}

void add_box_faces(const Triple& size, std::vector<Face>& faces) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      const auto corner = [&](double u, double v) {
        Triple p{};
        p[axis] = side * size[axis] / 2;
        p[(axis + 1) % 3] = u * size[(axis + 1) % 3] / 2;
        p[(axis + 2) % 3] = side * v * size[(axis + 2) % 3] / 2;
        return Vec3(p);
      };
      faces.push_back({corner(-1, -1), corner(1, -1), corner(1, 1)});
      faces.push_back({corner(-1, -1), corner(1, 1), corner(-1, 1)});
    }
  }
}

void add_mesh_faces(const multibody::ShapeDef& shape, std::vector<Face>& faces) {
  const auto vertex = [&](double index) {
    const auto i = 3 * static_cast<std::size_t>(index);
    return Vec3(shape.vertices[i], shape.vertices[i + 1], shape.vertices[i + 2]);
  };
  for (std::size_t t = 0; t + 2 < shape.triangles.size(); t += 3) {
    faces.push_back({vertex(shape.triangles[t]), vertex(shape.triangles[t + 1]), vertex(shape.triangles[t + 2])});
  }
}

void add_field_faces(const multibody::ShapeDef& shape, std::vector<Face>& faces) {
  const auto columns = static_cast<std::size_t>(shape.columns), rows = static_cast<std::size_t>(shape.rows);
  const auto point = [&](std::size_t column, std::size_t row) {
    return Vec3(static_cast<double>(column) * shape.spacing_x, static_cast<double>(row) * shape.spacing_y,
                shape.heights[row * columns + column]);
  };
  for (std::size_t row = 0; row + 1 < rows; ++row) {
    for (std::size_t column = 0; column + 1 < columns; ++column) {
      faces.push_back({point(column, row), point(column + 1, row), point(column + 1, row + 1)});
      faces.push_back({point(column, row), point(column + 1, row + 1), point(column, row + 1)});
    }
  }
}

void place_faces(const Triple& position, const Triple& orientation, std::vector<Face>& faces) {
  const math::Mat3 R = math::rotation_zxz(orientation);
  for (Face& face : faces) {
    for (Vec3& corner : face) corner = Vec3(position) + R * corner;
  }
}

}  // namespace

std::vector<Face> faces_of(const multibody::ShapeDef& shape) {
  std::vector<Face> faces;
  switch (shape.type) {
    case ShapeType::sphere:
      for (const double way : {-1.0, 1.0}) add_dome(shape.radius, 0, way, faces);
      break;
    case ShapeType::box:
      add_box_faces(shape.size, faces);
      break;
    case ShapeType::cylinder:
      add_cylinder_faces(shape.radius, shape.length, true, faces);
      break;
    case ShapeType::capsule:
      add_cylinder_faces(shape.radius, shape.length, false, faces);
      for (const double way : {-1.0, 1.0}) add_dome(shape.radius, way * shape.length / 2, way, faces);
      break;
    case ShapeType::convex_mesh:
    case ShapeType::triangle_mesh:
      add_mesh_faces(shape, faces);
      break;
    case ShapeType::height_field:
      add_field_faces(shape, faces);
      break;
    case ShapeType::plane:
      break;
  }
  place_faces(shape.position, shape.orientation, faces);
  return faces;
}

std::vector<Face> faces_of(const scene::GraphicDef& graphic, const std::string& folder,
                           std::vector<std::string>& left_out) {
  Problems problems;
  contact::MeshDef mesh;
  if (const auto refusal = scene::LoadContext{true, folder}.refusal_of(graphic.file)) {
    left_out.push_back(graphic.name + ": " + refusal->what);
    return {};
  }
  mesh = contact::read_mesh(graphic.name,
                            {.path = std::filesystem::path(folder) / graphic.file,
                             .unit = graphic.unit,
                             .up_in_file = graphic.up,
                             .up = contact::UpAxis::y},
                            problems);
  if (!problems.empty()) {
    left_out.push_back(graphic.name + ": " + problems.front().what);
    return {};
  }
  std::vector<Face> faces;
  for (const auto& [a, b, c] : mesh.triangles) {
    faces.push_back({Vec3(mesh.vertices[a]), Vec3(mesh.vertices[b]), Vec3(mesh.vertices[c])});
  }
  place_faces(graphic.position, graphic.orientation, faces);
  return faces;
}

}  // namespace slew::analysis
