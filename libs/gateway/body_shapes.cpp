// SPDX-License-Identifier: Apache-2.0
#include "gateway/body_shapes.h"

#include <algorithm>
#include <numbers>

namespace slew::gateway {
namespace {

using contact::ShapeType;
using math::Quaternion;
using math::Vec3;
using multibody::ShapeDef;

constexpr std::size_t kMostTriangles = 20'000;  // of a shape; a larger one is drawn as the box around it
constexpr double kPlaneSize = 40;               // m
constexpr double kPlaneThickness = 0.02;        // m
constexpr int kLineList = 2;                    // LinePrimitive: pairs of points

Json color_json(const Color& color) {
  return {{"r", color[0]}, {"g", color[1]}, {"b", color[2]}, {"a", 1.0}};
}

// Surface of a mesh or a height field, in the shape's axes.
struct Surface {
  std::vector<Vec3> points;
  std::vector<std::size_t> indices;  // three a triangle
};

Surface surface_of(const ShapeDef& shape) {
  Surface surface;
  if (shape.type == ShapeType::height_field) {
    const auto columns = static_cast<std::size_t>(shape.columns), rows = static_cast<std::size_t>(shape.rows);
    for (std::size_t i = 0; i < shape.heights.size(); ++i) {
      surface.points.emplace_back(static_cast<double>(i % columns) * shape.spacing_x,
                                  static_cast<double>(i / columns) * shape.spacing_y, shape.heights[i]);
    }
    for (std::size_t row = 0; row + 1 < rows; ++row) {
      for (std::size_t column = 0; column + 1 < columns; ++column) {
        const std::size_t a = row * columns + column, b = a + 1, c = a + columns, d = c + 1;
        surface.indices.insert(surface.indices.end(), {a, b, c, b, d, c});
      }
    }
    return surface;
  }
  for (std::size_t i = 0; i + 2 < shape.vertices.size(); i += 3)
    surface.points.emplace_back(shape.vertices[i], shape.vertices[i + 1], shape.vertices[i + 2]);
  for (const double index : shape.triangles) surface.indices.push_back(static_cast<std::size_t>(index));
  return surface;
}

void add_solid(const char* kind, Vec3 position, const Quaternion& orientation, Vec3 size, const Color& color,
               Json& primitives) {
  primitives[kind].push_back(
      {{"pose", pose_json(position, orientation)}, {"size", vector_json(size)}, {"color", color_json(color)}});
}

void add_surface(const ShapeDef& shape, const Quaternion& orientation, const Color& color, Json& primitives) {
  const Surface surface = surface_of(shape);
  if (surface.points.empty()) return;
  const Vec3 position(shape.position);
  if (surface.indices.size() > 3 * kMostTriangles) {
    std::array<double, 3> least = surface.points.front().array(), most = least;
    for (const Vec3& point : surface.points) {
      for (int k = 0; k < 3; ++k) {
        least[static_cast<std::size_t>(k)] = std::min(least[static_cast<std::size_t>(k)], point[k]);
        most[static_cast<std::size_t>(k)] = std::max(most[static_cast<std::size_t>(k)], point[k]);
      }
    }
    const Vec3 middle = 0.5 * (Vec3(least) + Vec3(most));
    add_solid("cubes", position + math::rotation_of(orientation) * middle, orientation, Vec3(most) - Vec3(least), color,
              primitives);
    return;
  }
  Json points = Json::array();
  for (const Vec3& point : surface.points) points.push_back(vector_json(point));
  primitives["triangles"].push_back({{"pose", pose_json(position, orientation)},
                                     {"points", std::move(points)},
                                     {"color", color_json(color)},
                                     {"colors", Json::array()},
                                     {"indices", surface.indices}});
}

void add_round(double radius, double length, Vec3 position, const Quaternion& orientation, const Color& color,
               Json& primitives) {
  primitives["cylinders"].push_back({{"pose", pose_json(position, orientation)},
                                     {"size", vector_json(Vec3(2 * radius, 2 * radius, length))},
                                     {"bottom_scale", 1.0},
                                     {"top_scale", 1.0},
                                     {"color", color_json(color)}});
}

}  // namespace

Json vector_json(Vec3 v) {
  return {{"x", v.x()}, {"y", v.y()}, {"z", v.z()}};
}

Json pose_json(Vec3 position, const Quaternion& q) {
  return {{"position", vector_json(position)}, {"orientation", {{"x", q.x}, {"y", q.y}, {"z", q.z}, {"w", q.w}}}};
}

void add_shape(const ShapeDef& shape, const Color& color, Json& primitives) {
  const math::Mat3 R = math::rotation_zxz(shape.orientation);
  const Quaternion q = math::quaternion_of(R);
  const Vec3 position(shape.position);
  const Vec3 ball(2 * shape.radius, 2 * shape.radius, 2 * shape.radius);
  switch (shape.type) {
    case ShapeType::sphere:
      return add_solid("spheres", position, q, ball, color, primitives);
    case ShapeType::box:
      return add_solid("cubes", position, q, Vec3(shape.size), color, primitives);
    case ShapeType::cylinder:
      return add_round(shape.radius, shape.length, position, q, color, primitives);
    case ShapeType::capsule:
      for (const double end : {-0.5, 0.5})
        add_solid("spheres", position + R * Vec3(0, 0, end * shape.length), q, ball, color, primitives);
      return add_round(shape.radius, shape.length, position, q, color, primitives);
    case ShapeType::plane:
      return add_solid("cubes", position + R * Vec3(0, 0, -kPlaneThickness / 2), q,
                       Vec3(kPlaneSize, kPlaneSize, kPlaneThickness), color, primitives);
    case ShapeType::convex_mesh:
    case ShapeType::triangle_mesh:
    case ShapeType::height_field:
      return add_surface(shape, q, color, primitives);
  }
}

void add_cylinder(double radius, double length, double z, const Color& color, Json& primitives) {
  add_round(radius, length, Vec3(0, 0, z), Quaternion(), color, primitives);
}

void add_model(const std::string& uri, Vec3 position, const Quaternion& orientation, Json& primitives) {
  const math::Mat3 R_quarter = math::rotation_zxz({0, -std::numbers::pi / 2, 0});
  const Quaternion q = math::quaternion_of(math::rotation_of(orientation) * R_quarter);
  primitives["models"].push_back({{"pose", pose_json(position, q)},
                                  {"scale", vector_json(Vec3(1, 1, 1))},
                                  {"color", color_json({1, 1, 1})},
                                  {"override_color", false},
                                  {"url", uri},
                                  {"media_type", "model/gltf-binary"},
                                  {"data", ""}});
}

void add_star(Vec3 hub, std::span<const Vec3> points, double thickness, const Color& color, Json& primitives) {
  Json ends = Json::array();
  for (const Vec3& point : points) {
    ends.push_back(vector_json(hub));
    ends.push_back(vector_json(point));
  }
  primitives["lines"].push_back({{"type", kLineList},
                                 {"pose", pose_json(Vec3(), Quaternion())},
                                 {"thickness", thickness},
                                 {"scale_invariant", false},
                                 {"points", std::move(ends)},
                                 {"color", color_json(color)},
                                 {"colors", Json::array()},
                                 {"indices", Json::array()}});
}

}  // namespace slew::gateway
