// SPDX-License-Identifier: Apache-2.0
#include "analysis/animation/machine_drawing.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "math/rotation.h"
#include "math/vector3.h"

namespace slew::analysis {
namespace {

using contact::ShapeType;
using math::Mat3;
using math::Vec3;
using multibody::ShapeDef;

constexpr int kRim = 24;             // lines of a circle
constexpr double kFlat = 0.97;       // cosine between faces whose common edge is not drawn
constexpr double kSamePoint = 1e-9;  // m
constexpr double kMark = 0.03;     // share of the machine's size: half a cross in the place of a body that has no line
constexpr double kLoneMark = 0.1;  // m, where nothing gives a size

Triple to_triple(const Vec3& v) {
  return {v[0], v[1], v[2]};
}

Polyline rim(double radius, int axis, double offset) {
  Polyline line;
  for (int i = 0; i <= kRim; ++i) {
    const double angle = 2 * std::numbers::pi * i / kRim;
    Triple point{};
    const auto a = static_cast<std::size_t>(axis);
    point[a] = offset;
    point[(a + 1) % 3] = radius * std::cos(angle);
    point[(a + 2) % 3] = radius * std::sin(angle);
    line.push_back(point);
  }
  return line;
}

void add_box(const Triple& size, std::vector<Polyline>& lines) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (int corner = 0; corner < 4; ++corner) {
      Triple from{};
      from[(axis + 1) % 3] = (corner & 1) != 0 ? size[(axis + 1) % 3] / 2 : -size[(axis + 1) % 3] / 2;
      from[(axis + 2) % 3] = (corner & 2) != 0 ? size[(axis + 2) % 3] / 2 : -size[(axis + 2) % 3] / 2;
      Triple to = from;
      from[axis] = -size[axis] / 2;
      to[axis] = size[axis] / 2;
      lines.push_back({from, to});
    }
  }
}

// edges of one face, or between faces at an angle
void add_mesh(const ShapeDef& shape, std::vector<Polyline>& lines) {
  const auto vertex = [&](double index) {
    const auto i = 3 * static_cast<std::size_t>(index);
    return Vec3{shape.vertices[i], shape.vertices[i + 1], shape.vertices[i + 2]};
  };
  std::map<std::pair<double, double>, std::vector<Vec3>> normals;
  for (std::size_t t = 0; t + 2 < shape.triangles.size(); t += 3) {
    const double* corners = &shape.triangles[t];
    const Vec3 a = vertex(corners[0]);
    const Vec3 normal = math::cross(vertex(corners[1]) - a, vertex(corners[2]) - a);
    const double size = math::norm(normal);
    for (std::size_t k = 0; k < 3; ++k) {
      const auto edge = std::minmax(corners[k], corners[(k + 1) % 3]);
      normals[{edge.first, edge.second}].push_back(size > 0 ? (1 / size) * normal : normal);
    }
  }
  for (const auto& [edge, of_faces] : normals) {
    if (of_faces.size() == 2 && math::dot(of_faces[0], of_faces[1]) > kFlat) continue;
    lines.push_back({to_triple(vertex(edge.first)), to_triple(vertex(edge.second))});
  }
}

void add_height_field(const ShapeDef& shape, std::vector<Polyline>& lines) {
  const auto columns = static_cast<std::size_t>(shape.columns), rows = static_cast<std::size_t>(shape.rows);
  const auto point = [&](std::size_t column, std::size_t row) {
    return Triple{static_cast<double>(column) * shape.spacing_x, static_cast<double>(row) * shape.spacing_y,
                  shape.heights[row * columns + column]};
  };
  for (const std::size_t row : {std::size_t{0}, rows - 1}) {
    lines.emplace_back();
    for (std::size_t column = 0; column < columns; ++column) lines.back().push_back(point(column, row));
  }
  for (const std::size_t column : {std::size_t{0}, columns - 1}) {
    lines.emplace_back();
    for (std::size_t row = 0; row < rows; ++row) lines.back().push_back(point(column, row));
  }
}

// in the shape's own axes
std::vector<Polyline> outline(const ShapeDef& shape) {
  std::vector<Polyline> lines;
  switch (shape.type) {
    case ShapeType::sphere:
      for (int axis = 0; axis < 3; ++axis) lines.push_back(rim(shape.radius, axis, 0));
      break;
    case ShapeType::box:
      add_box(shape.size, lines);
      break;
    case ShapeType::cylinder:
    case ShapeType::capsule:
      for (const double end : {-0.5, 0.5}) {
        lines.push_back(rim(shape.radius, 2, end * shape.length));
        if (shape.type == ShapeType::cylinder) continue;
        for (int axis = 0; axis < 2; ++axis) {
          lines.push_back(rim(shape.radius, axis, 0));
          for (Triple& point : lines.back()) point[2] += end * shape.length;
        }
      }
      for (const auto& [x, y] : {std::pair(1, 0), std::pair(-1, 0), std::pair(0, 1), std::pair(0, -1)}) {
        lines.push_back({{x * shape.radius, y * shape.radius, -shape.length / 2},
                         {x * shape.radius, y * shape.radius, shape.length / 2}});
      }
      break;
    case ShapeType::convex_mesh:
    case ShapeType::triangle_mesh:
      add_mesh(shape, lines);
      break;
    case ShapeType::height_field:
      add_height_field(shape, lines);
      break;
    case ShapeType::plane:
      break;
  }
  return lines;
}

void add_star(const Triple& hub, const std::vector<Triple>& points, std::vector<Polyline>& lines) {
  for (const Triple& point : points) {
    if (math::norm(to_vec(point) - to_vec(hub)) > kSamePoint) lines.push_back({hub, point});
  }
}

// Largest distance of any point from the origin of its body, and of any body from its parent; the ground may reach much
// further than the machine.
double size_of(const multibody::MechanicsDef& mechanics, const MachineDrawing& drawing) {
  double size = 0;
  for (const multibody::BodyDef& body : mechanics.bodies) size = std::max(size, math::norm(to_vec(body.position)));
  for (std::size_t i = 1; i < drawing.bodies.size(); ++i) {
    for (const Polyline& line : drawing.bodies[i].lines) {
      for (const Triple& point : line) size = std::max(size, math::norm(to_vec(point)));
    }
  }
  return size;
}

// Draws a cross for a body that has no joint, force or shape away from its centre of mass.
void mark_bare_bodies(const multibody::MechanicsDef& mechanics, MachineDrawing& drawing) {
  const double size = size_of(mechanics, drawing);
  const double mark = size > 0 ? kMark * size : kLoneMark;
  for (std::size_t i = 1; i < drawing.bodies.size(); ++i) {
    std::vector<Polyline>& lines = drawing.bodies[i].lines;
    if (!lines.empty()) continue;
    const Triple& middle = mechanics.bodies[i - 1].center_of_mass;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      Triple from = middle, to = middle;
      from[axis] -= mark;
      to[axis] += mark;
      lines.push_back({from, to});
    }
  }
}

std::array<Triple, 3> axes_of(const Triple& gravity) {
  const double g = math::norm(to_vec(gravity));
  const Vec3 up = g > 0 ? (-1 / g) * to_vec(gravity) : Vec3{0, 1, 0};
  const Vec3 x{1, 0, 0}, z{0, 0, 1};
  const Vec3 aside = std::fabs(up[0]) < 0.9 ? x : z;
  const Vec3 level = aside - math::dot(aside, up) * up;
  const Vec3 right = (1 / math::norm(level)) * level;
  return {to_triple(right), to_triple(math::cross(right, up)), to_triple(up)};
}

}  // namespace

MachineDrawing draw_machine(const multibody::MechanicsDef& mechanics) {
  MachineDrawing drawing;
  drawing.axes = axes_of(mechanics.gravity);
  std::map<std::string, std::size_t> index = {{"Ground", 0}};
  drawing.bodies.push_back({"Ground", {}});
  for (const multibody::BodyDef& body : mechanics.bodies) {
    index.emplace(body.name, drawing.bodies.size());
    drawing.bodies.push_back({body.name, {}});
  }
  std::vector<std::vector<Triple>> points(drawing.bodies.size());
  std::vector<Triple> hubs(drawing.bodies.size());
  std::vector<bool> has_hub(drawing.bodies.size(), false);
  for (const multibody::JointDef& joint : mechanics.joints) {
    points[index.at(joint.body1)].push_back(joint.point1);
    const std::size_t carried = index.at(joint.body2);
    points[carried].push_back(joint.point2);
    if (!has_hub[carried]) hubs[carried] = joint.point2;
    has_hub[carried] = true;
  }
  for (const multibody::TranslationalForceDef& force : mechanics.translational_forces) {
    const std::size_t body1 = index.at(force.body1), body2 = index.at(force.body2);
    points[body1].push_back(force.point1);
    points[body2].push_back(force.point2);
    drawing.links.push_back({force.name, body1, body2, force.point1, force.point2});
  }
  for (std::size_t i = 1; i < drawing.bodies.size(); ++i) {
    points[i].push_back(mechanics.bodies[i - 1].center_of_mass);
    add_star(hubs[i], points[i], drawing.bodies[i].lines);
  }
  for (const ShapeDef& shape : mechanics.shapes) {
    const Mat3 R = math::rotation_zxz(shape.orientation);
    for (Polyline line : outline(shape)) {
      for (Triple& point : line) point = to_triple(to_vec(shape.position) + R * to_vec(point));
      drawing.bodies[index.at(shape.body)].lines.push_back(std::move(line));
    }
  }
  mark_bare_bodies(mechanics, drawing);
  return drawing;
}

}  // namespace slew::analysis
