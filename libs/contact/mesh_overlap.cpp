// SPDX-License-Identifier: Apache-2.0
#include "contact/mesh_overlap.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "contact/mesh_check.h"
#include "contact/triangle_tree.h"

namespace slew::contact {
namespace {

using math::Vec3;

constexpr int kLines = 16384;

// Crossing of a line with the surface: place along the line, change of w.
struct Crossing {
  double place;
  int change;
};

// Lines along one axis; the others are its sides, in cyclic order.
struct Lines {
  int axis, side_1, side_2;
};

class Surface {
 public:
  explicit Surface(const MeshDef& mesh) : extent_(extent_of(mesh)) {
    for (const Triple& v : mesh.vertices) vertices_.emplace_back(v);
    triangles_.assign(mesh.triangles.begin(), mesh.triangles.end());
    tree_ = TriangleTree(vertices_, triangles_);
  }

  [[nodiscard]] const Extent& extent() const noexcept { return extent_; }

  // Crossings of the line through (x_1, x_2), ascending; leaving before entering at one place.
  void cross(const Lines& lines, double x_1, double x_2, std::vector<Crossing>& crossings) const {
    crossings.clear();
    Vec3 low = extent_.low, high = extent_.high;
    low.lanes[lines.side_1] = high.lanes[lines.side_1] = x_1;
    low.lanes[lines.side_2] = high.lanes[lines.side_2] = x_2;
    tree_.visit_box(low, high, [&](std::uint32_t triangle) { add_crossing(triangle, lines, x_1, x_2, crossings); });
    std::sort(crossings.begin(), crossings.end(), [](const Crossing& a, const Crossing& b) {
      return a.place < b.place || (a.place == b.place && a.change < b.change);
    });
  }

 private:
  void add_crossing(std::uint32_t triangle, const Lines& lines, double x_1, double x_2,
                    std::vector<Crossing>& crossings) const {
    // twice the signed areas that the line's point makes with the edges, seen along the axis
    double share[3], sum = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 &from = vertices_[triangles_[triangle][(k + 1) % 3]],
                 &to = vertices_[triangles_[triangle][(k + 2) % 3]];
      share[k] =
          (from[lines.side_1] - x_1) * (to[lines.side_2] - x_2) - (from[lines.side_2] - x_2) * (to[lines.side_1] - x_1);
      sum += share[k];
    }
    const bool is_left = share[0] > 0 && share[1] > 0 && share[2] > 0;
    const bool is_right = share[0] < 0 && share[1] < 0 && share[2] < 0;
    if (!is_left && !is_right) return;
    double place = 0;
    for (std::size_t k = 0; k < 3; ++k) place += share[k] / sum * vertices_[triangles_[triangle][k]][lines.axis];
    // a normal along the axis points out of the solid that the line leaves
    crossings.push_back({place, is_left ? -1 : 1});
  }

  Extent extent_;
  std::vector<Vec3> vertices_;
  std::vector<Triangle> triangles_;
  TriangleTree tree_;
};

}  // namespace

DoubledVolume find_doubled_volume(const MeshDef& mesh) {
  const Surface surface(mesh);
  const auto [low, high] = surface.extent();
  constexpr double kGolden = 1 / std::numbers::phi;
  DoubledVolume found;
  double longest = 0;
  std::vector<Crossing> crossings;
  for (int axis = 0; axis < 3; ++axis) {
    const Lines lines{axis, (axis + 1) % 3, (axis + 2) % 3};
    const double width_1 = high[lines.side_1] - low[lines.side_1], width_2 = high[lines.side_2] - low[lines.side_2];
    double length = 0;
    for (int i = 0; i < kLines; ++i) {
      const double x_1 = low[lines.side_1] + width_1 * (i + 0.5) / kLines;
      const double x_2 = low[lines.side_2] + width_2 * std::fmod((i + 0.5) * kGolden, 1.0);
      surface.cross(lines, x_1, x_2, crossings);
      int around = 0;
      for (const Crossing& crossing : crossings) around += crossing.change;
      if (around != 0) continue;
      for (std::size_t k = 0; k + 1 < crossings.size(); ++k) {
        around += crossings[k].change;
        const int excess = std::abs(around - std::clamp(around, 0, 1));
        const double part = crossings[k + 1].place - crossings[k].place;
        length += excess * part;
        if (excess == 0 || part <= longest) continue;
        longest = part;
        found.place.lanes[axis] = 0.5 * (crossings[k].place + crossings[k + 1].place);
        found.place.lanes[lines.side_1] = x_1;
        found.place.lanes[lines.side_2] = x_2;
      }
    }
    found.volume = std::max(found.volume, width_1 * width_2 / kLines * length);
  }
  return found;
}

}  // namespace slew::contact
