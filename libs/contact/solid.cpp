// SPDX-License-Identifier: Apache-2.0
#include "contact/solid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

namespace slew::contact {
namespace {

using math::Vec3;

// tolerance of the normals within one flat face; meshes carry six digits and more
constexpr double kCoplanar = 1e-5;

Vec3 normal_of(const Geometry& g, const Triangle& t) {
  const Vec3 n = cross(g.vertices[t[1]] - g.vertices[t[0]], g.vertices[t[2]] - g.vertices[t[0]]);
  return n * (1 / norm(n));
}

void bound_vertices(Geometry& g) {
  Vec3 low = g.vertices[0], high = g.vertices[0];
  for (const Vec3& v : g.vertices) {
    for (int k = 0; k < 3; ++k) {
      low.lanes[k] = std::min(low[k], v[k]);
      high.lanes[k] = std::max(high[k], v[k]);
    }
  }
  g.centre = (low + high) * 0.5;
  g.half_size = (high - low) * 0.5;
  for (const Vec3& v : g.vertices) g.bounding_radius = std::max(g.bounding_radius, norm(v - g.centre));
}

// Face of a triangle: all vertices in its plane, since the mesh is convex, in order of their angle.
void merge_faces(Geometry& g) {
  double size = g.bounding_radius;
  for (const auto& triangle : g.triangles) {
    const Vec3 n = normal_of(g, triangle), on = g.vertices[triangle[0]];
    const bool is_known = std::any_of(g.faces.begin(), g.faces.end(), [&](const Geometry::FlatFace& face) {
      return norm(face.normal - n) < kCoplanar;
    });
    if (is_known) continue;
    std::vector<std::uint32_t> corners;
    Vec3 middle;
    for (std::uint32_t i = 0; i < g.vertices.size(); ++i) {
      if (std::fabs(dot(g.vertices[i] - on, n)) > kCoplanar * size) continue;
      corners.push_back(i);
      middle += g.vertices[i];
    }
    middle = middle * (1 / static_cast<double>(corners.size()));
    const Vec3 x = (on - middle) * (1 / norm(on - middle)), y = cross(n, x);
    const auto angle = [&](std::uint32_t i) {
      const Vec3 r = g.vertices[i] - middle;
      return std::atan2(dot(r, y), dot(r, x));
    };
    std::stable_sort(corners.begin(), corners.end(),
                     [&](std::uint32_t i, std::uint32_t j) { return angle(i) < angle(j); });
    // a rounded face with very many corners is represented by evenly chosen ones
    const std::size_t stride = (corners.size() + kMaxFaceVertices - 1) / kMaxFaceVertices;
    Geometry::FlatFace face{n, g.face_vertices.size(), 0};
    for (std::size_t i = 0; i < corners.size(); i += stride) g.face_vertices.push_back(corners[i]);
    face.count = g.face_vertices.size() - face.first;
    g.faces.push_back(face);
  }
}

// two triangles per cell, upward
void triangulate(const HeightFieldDef& field, Geometry& g) {
  for (std::size_t row = 0; row < field.rows; ++row) {
    for (std::size_t column = 0; column < field.columns; ++column) {
      g.vertices.emplace_back(static_cast<double>(column) * field.spacing_x, static_cast<double>(row) * field.spacing_y,
                              field.heights[row * field.columns + column]);
    }
  }
  const auto index = [&](std::size_t row, std::size_t column) {
    return static_cast<std::uint32_t>(row * field.columns + column);
  };
  for (std::size_t row = 0; row + 1 < field.rows; ++row) {
    for (std::size_t column = 0; column + 1 < field.columns; ++column) {
      g.triangles.push_back({index(row, column), index(row, column + 1), index(row + 1, column + 1)});
      g.triangles.push_back({index(row, column), index(row + 1, column + 1), index(row + 1, column)});
    }
  }
}

// An edge is open if it has no neighbour, or if the neighbour falls away by more than 30 degrees.
void find_open_edges(Geometry& g) {
  constexpr double kSharp = 0.866;  // cosine
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> owner;
  for (std::size_t i = 0; i < g.triangles.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) owner[{g.triangles[i][k], g.triangles[i][(k + 1) % 3]}] = i;
  }
  for (std::size_t i = 0; i < g.triangles.size(); ++i) {
    const Triangle& t = g.triangles[i];
    std::uint8_t ways = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto neighbour = owner.find({t[(k + 1) % 3], t[k]});
      bool falls_away = true;
      if (neighbour != owner.end()) {
        const Vec3 across = g.triangle_normals[neighbour->second];
        const Vec3 inward = cross(g.triangle_normals[i], g.vertices[t[(k + 1) % 3]] - g.vertices[t[k]]);
        // convex: the neighbour faces away from this triangle
        falls_away = dot(across, g.triangle_normals[i]) < kSharp && dot(across, inward) < 0;
      }
      if (falls_away) ways = static_cast<std::uint8_t>(ways | (1U << k));
    }
    g.open_edges.push_back(ways);
  }
}

Face box_face(const Solid& s, Vec3 d) noexcept {
  int axis = 0;
  for (int k = 1; k < 3; ++k) {
    if (std::fabs(d[k]) > std::fabs(d[axis])) axis = k;
  }
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const double side = d[axis] < 0 ? -1.0 : 1.0;
  const Vec3 h = s.geometry->half_size;
  Face face;
  // counter-clockwise seen from outside; the lower side turns the other way
  for (const auto& corner : {std::array{-1.0, -1.0}, {1.0, -1.0}, {1.0, 1.0}, {-1.0, 1.0}}) {
    Vec3 p;
    p.lanes[axis] = side * h[axis];
    p.lanes[u] = side * corner[0] * h[u];
    p.lanes[v] = corner[1] * h[v];
    face.vertices.push_back(s.to_world(p));
  }
  face.normal = s.R_WS.c[axis] * side;
  return face;
}

// a cap as an octagon if it faces d squarely, else the line of the side
Face cylinder_face(const Solid& s, Vec3 d) noexcept {
  constexpr int kCorners = 8;
  const Geometry& g = *s.geometry;
  Face face;
  const double across = std::hypot(d.x(), d.y());
  const double side = d.z() < 0 ? -1.0 : 1.0;
  if (std::fabs(d.z()) > across) {
    // a corner where the rim reaches farthest
    const double first = std::atan2(d.y(), d.x());
    for (int i = 0; i < kCorners; ++i) {
      const double angle = first + side * i * 2 * M_PI / kCorners;
      face.vertices.push_back(
          s.to_world({g.radius * std::cos(angle), g.radius * std::sin(angle), side * g.half_length}));
    }
    face.normal = s.R_WS.c[2] * side;
    return face;
  }
  const double x = g.radius * d.x() / across, y = g.radius * d.y() / across;
  face.vertices.push_back(s.to_world({x, y, -g.half_length}));
  face.vertices.push_back(s.to_world({x, y, g.half_length}));
  return face;
}

Face mesh_face(const Solid& s, Vec3 d) noexcept {
  const Geometry& g = *s.geometry;
  std::size_t best = 0;
  for (std::size_t i = 1; i < g.faces.size(); ++i) {
    if (dot(g.faces[i].normal, d) > dot(g.faces[best].normal, d)) best = i;
  }
  Face face;
  for (std::size_t i = 0; i < g.faces[best].count; ++i) {
    face.vertices.push_back(s.to_world(g.vertices[g.face_vertices[g.faces[best].first + i]]));
  }
  face.normal = s.R_WS * g.faces[best].normal;
  return face;
}

}  // namespace

Geometry make_geometry(const ShapeDef& def) {
  Geometry g;
  g.type = def.type;
  g.radius = def.radius;
  g.half_length = def.length / 2;
  g.half_size = Vec3(def.size) * 0.5;
  switch (def.type) {
    case ShapeType::sphere:
      g.bounding_radius = g.radius;
      break;
    case ShapeType::box:
      g.bounding_radius = norm(g.half_size);
      break;
    case ShapeType::cylinder:
      g.bounding_radius = std::hypot(g.radius, g.half_length);
      break;
    case ShapeType::capsule:
      g.bounding_radius = g.radius + g.half_length;
      break;
    case ShapeType::plane:
      g.bounding_radius = std::numeric_limits<double>::infinity();
      break;
    case ShapeType::height_field:
      triangulate(def.height_field, g);
      break;
    case ShapeType::convex_mesh:
    case ShapeType::triangle_mesh:
      for (const Triple& v : def.mesh.vertices) g.vertices.emplace_back(v);
      g.triangles = def.mesh.triangles;
      break;
  }
  if (!g.vertices.empty()) bound_vertices(g);
  if (def.type == ShapeType::convex_mesh) {
    for (const Vec3& v : g.vertices) g.inside += v * (1 / static_cast<double>(g.vertices.size()));
    merge_faces(g);
  }
  if (def.type == ShapeType::triangle_mesh || def.type == ShapeType::height_field) {
    for (const Triangle& triangle : g.triangles) g.triangle_normals.push_back(normal_of(g, triangle));
    find_open_edges(g);
    g.tree = TriangleTree(g.vertices, g.triangles);
  }
  return g;
}

double inner_radius(const Geometry& g) noexcept {
  switch (g.type) {
    case ShapeType::sphere:
    case ShapeType::capsule:
      return g.radius;
    case ShapeType::cylinder:
      return std::min(g.radius, g.half_length);
    case ShapeType::box:
      return std::min({g.half_size[0], g.half_size[1], g.half_size[2]});
    case ShapeType::plane:
      return std::numeric_limits<double>::infinity();
    case ShapeType::convex_mesh: {
      double least = g.bounding_radius;
      for (const Geometry::FlatFace& face : g.faces) {
        least = std::min(least, dot(g.vertices[g.face_vertices[face.first]] - g.centre, face.normal));
      }
      return std::max(least, 0.0);
    }
    case ShapeType::height_field:
    case ShapeType::triangle_mesh:
      break;
  }
  return 0;
}

double reach(const Solid& solid, Vec3 d_W) noexcept {
  const Geometry& g = *solid.geometry;
  const Vec3 d = transpose_multiply(solid.R_WS, d_W);
  const double origin = dot(solid.p_WS, d_W);
  switch (g.type) {
    case ShapeType::box:
      return origin + g.half_size[0] * std::fabs(d[0]) + g.half_size[1] * std::fabs(d[1]) +
             g.half_size[2] * std::fabs(d[2]);
    case ShapeType::cylinder:
      return origin + g.radius * std::hypot(d.x(), d.y()) + g.half_length * std::fabs(d.z());
    case ShapeType::capsule:
      return origin + g.radius + g.half_length * std::fabs(d.z());
    case ShapeType::convex_mesh: {
      double farthest = dot(g.vertices[0], d);
      for (const Vec3& vertex : g.vertices) farthest = std::max(farthest, dot(vertex, d));
      return origin + farthest;
    }
    default:
      return origin + g.radius;
  }
}

Vec3 farthest_point(const Geometry& g, Vec3 d) noexcept {
  const auto toward = [](double along, double extent) { return along < 0 ? -extent : extent; };
  switch (g.type) {
    case ShapeType::box:
      return {toward(d[0], g.half_size[0]), toward(d[1], g.half_size[1]), toward(d[2], g.half_size[2])};
    case ShapeType::cylinder: {
      const double across = std::hypot(d.x(), d.y());
      const double scale = across > 0 ? g.radius / across : 0.0;
      return {scale * d.x(), scale * d.y(), toward(d.z(), g.half_length)};
    }
    case ShapeType::convex_mesh: {
      std::size_t best = 0;
      double farthest = dot(g.vertices[0], d);
      for (std::size_t i = 1; i < g.vertices.size(); ++i) {
        const double along = dot(g.vertices[i], d);
        if (along <= farthest) continue;
        farthest = along;
        best = i;
      }
      return g.vertices[best];
    }
    default: {  // sphere, capsule
      const double length = norm(d);
      const Vec3 round = length > 0 ? d * (g.radius / length) : Vec3();
      return round + Vec3(0, 0, toward(d.z(), g.half_length));
    }
  }
}

Face supporting_face(const Solid& solid, Vec3 d_W) noexcept {
  const Geometry& g = *solid.geometry;
  const Vec3 d = transpose_multiply(solid.R_WS, d_W);
  switch (g.type) {
    case ShapeType::box:
      return box_face(solid, d);
    case ShapeType::cylinder:
      return cylinder_face(solid, d);
    case ShapeType::convex_mesh:
      return mesh_face(solid, d);
    case ShapeType::capsule: {
      Face face;
      for (const double end : {-g.half_length, g.half_length}) {
        face.vertices.push_back(solid.to_world({0, 0, end}) + d_W * g.radius);
      }
      return face;
    }
    default: {
      Face face;
      face.vertices.push_back(solid.p_WS + d_W * g.radius);
      return face;
    }
  }
}

}  // namespace slew::contact
