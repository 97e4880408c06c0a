// SPDX-License-Identifier: Apache-2.0
#include "contact/mesh_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <utility>
#include <vector>

#include "contact/mesh_overlap.h"
#include "math/vector3.h"

namespace slew::contact {
namespace {

using math::Vec3;

// tolerance for vertices printed with six digits: distance outside of a face as a share of the mesh's size
constexpr double kConvexTolerance = 1e-6;
// triangles whose area is below this share of the size squared are lines
constexpr double kAreaTolerance = 1e-12;
// share of the volume that may count twice: a tenth of the accuracy at which a mass is known
constexpr double kMostDoubled = 1e-3;

// share of the size cubed below which a closed part has no volume: a sheet of two sides
constexpr double kVolumeTolerance = 1e-9;

constexpr const char* kTurning = "triangles that all turn counter-clockwise seen from outside";

double size_of(const MeshDef& mesh) {
  const auto [low, high] = extent_of(mesh);
  return norm(high - low);
}

// vector of twice the area along the normal
Vec3 area_of(const MeshDef& mesh, std::size_t triangle) {
  const auto& t = mesh.triangles[triangle];
  const Vec3 on(mesh.vertices[t[0]]);
  return cross(Vec3(mesh.vertices[t[1]]) - on, Vec3(mesh.vertices[t[2]]) - on);
}

// directed edges and a triangle that has each
using Edges = std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t>;

std::optional<MeshFault> collect_edges(const MeshDef& mesh, Edges& edges) {
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto& t = mesh.triangles[i];
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [at, is_new] = edges.insert({{t[k], t[(k + 1) % 3]}, i});
      if (is_new) continue;
      return MeshFault{fmt::format("triangles {} and {} turn differently, or more than two meet, at the edge of "
                                   "vertices {} and {}",
                                   at->second, i, t[k], t[(k + 1) % 3]),
                       kTurning};
    }
  }
  return std::nullopt;
}

// six times the volume enclosed, about a vertex so that a mesh far from the origin is judged as well
double volume_of(const MeshDef& mesh) {
  const Vec3 origin(mesh.vertices[0]);
  double volume = 0;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    volume += dot(Vec3(mesh.vertices[mesh.triangles[i][0]]) - origin, area_of(mesh, i));
  }
  return volume;
}

}  // namespace

Extent extent_of(const MeshDef& mesh) {
  Vec3 low(mesh.vertices[0]), high(mesh.vertices[0]);
  for (const Triple& v : mesh.vertices) {
    for (std::size_t k = 0; k < 3; ++k) {
      const int lane = static_cast<int>(k);
      low.lanes[lane] = std::min(low[lane], v[k]);
      high.lanes[lane] = std::max(high[lane], v[k]);
    }
  }
  return {low, high};
}

std::optional<MeshFault> find_number_fault(const MeshDef& mesh) {
  if (mesh.vertices.size() < 3 || mesh.triangles.empty()) {
    return MeshFault{
        fmt::format("{} vertices and {} triangles are no surface", mesh.vertices.size(), mesh.triangles.size()),
        "at least one triangle"};
  }
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Triple& v = mesh.vertices[i];
    if (std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2])) continue;
    return MeshFault{fmt::format("vertex {} is not finite", i), "finite vertices"};
  }
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto& t = mesh.triangles[i];
    if (*std::max_element(t.begin(), t.end()) < mesh.vertices.size()) continue;
    return MeshFault{fmt::format("triangle {} has a vertex that does not exist", i),
                     fmt::format("indices below {}", mesh.vertices.size())};
  }
  return std::nullopt;
}

std::optional<MeshFault> find_surface_fault(const MeshDef& mesh) {
  if (auto fault = find_number_fault(mesh)) return fault;
  const double size = size_of(mesh);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (norm(area_of(mesh, i)) > kAreaTolerance * size * size) continue;
    return MeshFault{fmt::format("triangle {} has no area", i), "triangles with three corners"};
  }
  Edges edges;
  return collect_edges(mesh, edges);
}

std::optional<MeshFault> find_closed_fault(const MeshDef& mesh) {
  if (auto fault = find_surface_fault(mesh)) return fault;
  Edges edges;
  if (auto fault = collect_edges(mesh, edges)) return fault;
  for (const auto& [edge, triangle] : edges) {
    if (edges.contains({edge.second, edge.first})) continue;
    return MeshFault{fmt::format("it is not closed: triangle {} has no neighbour at the edge of vertices {} and {}",
                                 triangle, edge.first, edge.second),
                     "a closed mesh"};
  }
  if (!(volume_of(mesh) > 0)) return MeshFault{"it is inside out", kTurning};
  return std::nullopt;
}

namespace {

// triangles of an edge of a lower and a higher vertex: those that run upwards less those that run downwards
struct EdgeBalance {
  int sum = 0;
  std::size_t triangle = 0;  // the first
};

// vertices that triangles connect, by union of their sets
class Parts {
 public:
  explicit Parts(const MeshDef& mesh) : parent_(mesh.vertices.size()) {
    std::iota(parent_.begin(), parent_.end(), 0U);
    for (const auto& t : mesh.triangles) {
      parent_[of(t[0])] = of(t[1]);
      parent_[of(t[1])] = of(t[2]);
    }
  }
  [[nodiscard]] std::uint32_t of(std::uint32_t vertex) {
    while (parent_[vertex] != vertex) vertex = parent_[vertex] = parent_[parent_[vertex]];
    return vertex;
  }

 private:
  std::vector<std::uint32_t> parent_;
};

struct Part {
  double volume6 = 0;
  Extent extent{};
  std::size_t triangle = 0;  // the first
};

bool holds(const Extent& outer, const Extent& inner) {
  for (int k = 0; k < 3; ++k) {
    if (inner.low[k] < outer.low[k] || inner.high[k] > outer.high[k]) return false;
  }
  return true;
}

std::vector<Part> parts_of(const MeshDef& mesh) {
  Parts sets(mesh);
  std::map<std::uint32_t, std::size_t> index;
  std::vector<Part> parts;
  const Vec3 origin(mesh.vertices[0]);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto [at, is_new] = index.insert({sets.of(mesh.triangles[i][0]), parts.size()});
    const Vec3 first(mesh.vertices[mesh.triangles[i][0]]);
    if (is_new) parts.push_back({0, {first, first}, i});
    Part& part = parts[at->second];
    part.volume6 += dot(first - origin, area_of(mesh, i));
    for (const std::uint32_t vertex : mesh.triangles[i]) {
      for (int k = 0; k < 3; ++k) {
        const double x = mesh.vertices[vertex][static_cast<std::size_t>(k)];
        part.extent.low.lanes[k] = std::min(part.extent.low[k], x);
        part.extent.high.lanes[k] = std::max(part.extent.high[k], x);
      }
    }
  }
  return parts;
}

}  // namespace

std::optional<MeshFault> find_touched_fault(const MeshDef& mesh) {
  if (auto fault = find_surface_fault(mesh)) return fault;
  Edges edges;
  if (auto fault = collect_edges(mesh, edges)) return fault;
  Parts sets(mesh);
  std::set<std::uint32_t> open;
  for (const auto& [edge, triangle] : edges) {
    if (!edges.contains({edge.second, edge.first})) open.insert(sets.of(edge.first));
  }
  const std::vector<Part> parts = parts_of(mesh);
  for (const Part& part : parts) {
    const double size = norm(part.extent.high - part.extent.low);
    if (!(part.volume6 < -kVolumeTolerance * size * size * size)) continue;
    if (open.contains(sets.of(mesh.triangles[part.triangle][0]))) continue;
    const bool is_hole = std::any_of(parts.begin(), parts.end(), [&](const Part& other) {
      return &other != &part && holds(other.extent, part.extent) && !holds(part.extent, other.extent);
    });
    if (is_hole) continue;
    return MeshFault{
        parts.size() == 1 ? "it is inside out" : fmt::format("its part with triangle {} is inside out", part.triangle),
        fmt::format("{}: flip them in the program that made the file. A room that is touched from within "
                    "is an open surface, or has walls with a thickness",
                    kTurning)};
  }
  return std::nullopt;
}

namespace {

// solids that share more than kMostDoubled of the volume
std::optional<MeshFault> find_overlap_fault(const MeshDef& mesh) {
  const DoubledVolume doubled = find_doubled_volume(mesh);
  const double share = doubled.volume / (volume_of(mesh) / 6);
  if (share <= kMostDoubled) return std::nullopt;
  return MeshFault{fmt::format("its solids overlap, or one lies in another: about {:.2g} % of the volume counts twice, "
                               "such as that at ({:.4g}, {:.4g}, {:.4g}) m",
                               100 * share, doubled.place[0], doubled.place[1], doubled.place[2]),
                   "solids that touch at most: unite them in the program that made the file, or cut one out of the "
                   "other"};
}

}  // namespace

std::optional<MeshFault> find_solid_fault(const MeshDef& mesh) {
  if (auto fault = find_number_fault(mesh)) return fault;
  std::map<std::pair<std::uint32_t, std::uint32_t>, EdgeBalance> edges;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto& t = mesh.triangles[i];
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t from = t[k], to = t[(k + 1) % 3];
      if (from == to) continue;
      edges.try_emplace(std::minmax(from, to), EdgeBalance{0, i}).first->second.sum += from < to ? 1 : -1;
    }
  }
  for (const auto& [edge, balance] : edges) {
    if (balance.sum == 0) continue;
    if (balance.sum % 2 == 0) {
      return MeshFault{fmt::format("triangles turn differently at the edge of vertices {} and {} (triangle {})",
                                   edge.first, edge.second, balance.triangle),
                       kTurning};
    }
    return MeshFault{fmt::format("it is not closed: triangle {} has no neighbour at the edge of vertices {} and {}",
                                 balance.triangle, edge.first, edge.second),
                     "a closed mesh"};
  }
  if (!(volume_of(mesh) > 0)) return MeshFault{"it is inside out", kTurning};
  const std::vector<Part> parts = parts_of(mesh);
  for (const Part& part : parts) {
    if (!(part.volume6 < 0)) continue;
    const bool is_hole = std::any_of(parts.begin(), parts.end(), [&part](const Part& other) {
      return other.volume6 > -part.volume6 && holds(other.extent, part.extent);
    });
    if (is_hole) continue;
    return MeshFault{
        fmt::format("the part with triangle {} is inside out, and no other part surrounds it", part.triangle),
        kTurning};
  }
  return find_overlap_fault(mesh);
}

std::optional<MeshFault> find_convex_fault(const MeshDef& mesh) {
  if (auto fault = find_closed_fault(mesh)) return fault;
  const double size = size_of(mesh);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const Vec3 on(mesh.vertices[mesh.triangles[i][0]]), area = area_of(mesh, i);
    for (std::size_t k = 0; k < mesh.vertices.size(); ++k) {
      const double outside = dot(Vec3(mesh.vertices[k]) - on, area) / norm(area);
      if (outside <= kConvexTolerance * size) continue;
      return MeshFault{fmt::format("it is not convex: vertex {} is {:.3g} m outside of triangle {}", k, outside, i),
                       "a convex mesh; split others into convex parts"};
    }
  }
  return std::nullopt;
}

std::optional<MeshFault> find_field_fault(const HeightFieldDef& field) {
  if (field.columns < 2 || field.rows < 2) {
    return MeshFault{fmt::format("{} columns and {} rows are no surface", field.columns, field.rows),
                     "at least 2 of each"};
  }
  if (field.heights.size() != field.columns * field.rows) {
    return MeshFault{fmt::format("it has {} heights", field.heights.size()),
                     fmt::format("columns times rows, {}", field.columns * field.rows)};
  }
  for (const double spacing : {field.spacing_x, field.spacing_y}) {
    if (std::isfinite(spacing) && spacing > 0) continue;
    return MeshFault{fmt::format("a spacing of {} m is out of range", spacing), "a number > 0 m"};
  }
  for (std::size_t i = 0; i < field.heights.size(); ++i) {
    if (!std::isfinite(field.heights[i])) return MeshFault{fmt::format("height {} is not finite", i), "finite heights"};
  }
  return std::nullopt;
}

}  // namespace slew::contact
