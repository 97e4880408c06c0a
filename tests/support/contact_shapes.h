// SPDX-License-Identifier: Apache-2.0
// Shapes of tests: definitions in a line each, and a scene of two shapes.
#pragma once

#include <cmath>

#include "contact/contact_model.h"

namespace slew::contact::testing {

inline ShapeDef sphere(double radius) {
  ShapeDef def;
  def.type = ShapeType::sphere;
  def.radius = radius;
  return def;
}

inline ShapeDef box(double x, double y, double z) {
  ShapeDef def;
  def.type = ShapeType::box;
  def.size = {x, y, z};
  return def;
}

inline ShapeDef rounded(ShapeType type, double radius, double length) {
  ShapeDef def;
  def.type = type;
  def.radius = radius;
  def.length = length;
  return def;
}

inline ShapeDef plane() {
  ShapeDef def;
  def.type = ShapeType::plane;
  return def;
}

// the box as a mesh of twelve triangles
inline ShapeDef box_mesh(double x, double y, double z) {
  ShapeDef def;
  def.type = ShapeType::convex_mesh;
  for (int i = 0; i < 8; ++i) {
    def.mesh.vertices.push_back(
        {(i & 1) != 0 ? x / 2 : -x / 2, (i & 2) != 0 ? y / 2 : -y / 2, (i & 4) != 0 ? z / 2 : -z / 2});
  }
  def.mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                        {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return def;
}

inline void append(MeshDef& mesh, const MeshDef& other) {
  const auto offset = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const auto& t : other.triangles) mesh.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
}

// regular prism of n sides about z
inline MeshDef prism(std::uint32_t n, double r, double h) {
  MeshDef mesh;
  for (std::uint32_t i = 0; i < n; ++i) {
    const double angle = 2 * M_PI * i / n;
    mesh.vertices.push_back({r * std::cos(angle), r * std::sin(angle), -h / 2});
    mesh.vertices.push_back({r * std::cos(angle), r * std::sin(angle), h / 2});
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t low = 2 * i, next = 2 * ((i + 1) % n);
    mesh.triangles.push_back({low, next, low + 1});
    mesh.triangles.push_back({next, next + 1, low + 1});
    if (i == 0 || i + 1 == n) continue;
    mesh.triangles.push_back({0, next, low});
    mesh.triangles.push_back({1, low + 1, next + 1});
  }
  return mesh;
}

// columns x rows heights of 0 with the spacing [m]
inline ShapeDef flat_field(std::size_t columns, std::size_t rows, double spacing) {
  ShapeDef def;
  def.type = ShapeType::height_field;
  def.height_field = {columns, rows, spacing, spacing, std::vector<double>(columns * rows)};
  return def;
}

// shape a in a body that moves, shape b in Ground, one pair
inline ContactDef two_shapes(ShapeDef a, ShapeDef b) {
  ContactDef def;
  def.frames = {{"Ground", true}, {"Body", false}};
  a.name = "A";
  a.frame = "Body";
  b.name = "B";
  b.frame = "Ground";
  def.shapes = {a, b};
  def.pairs = {{.name = "Pair", .shape_a = "A", .shape_b = "B", .normal = {.stiffness = 1e6}, .friction = {}}};
  return def;
}

}  // namespace slew::contact::testing
