// SPDX-License-Identifier: Apache-2.0
// Gears in the model, and their rows in joint and body coordinates. Internal to the library.
//
//   g = q_2 - r q_1 - b,   g' = u_2 - r u_1,   g'' = u_2' - r u_1'                                       (1)
// Both joints belong to the tree, whose coordinates count whole turns. In the recursion (1) is a row of J itself, in
// body coordinates the gradients of both coordinates over up to four links.
// Source: Haug 1989, section 9.4 (gear and rack-and-pinion constraints), there over relative coordinates as here.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "math/rotation.h"
#include "multibody/constraints/gear_defs.h"

namespace slew::multibody {

struct Model;
struct State;
struct Workspace;
struct BodyModel;
struct RowValue;
struct MechanicsDef;

// A coordinate that a gear holds to another.
struct GearEnd {
  int joint = 0;      // Model::joints
  int link = 0;       // link that the joint moves
  int q = 0, u = 0;   // its coordinate and speed
  double factor = 1;  // dg/dq: -r at joint 1, 1 at joint 2
};

struct Gear {
  std::string name;
  GearKind kind = GearKind::gear;
  std::array<GearEnd, 2> ends{};  // joint 1, joint 2
  double offset = 0;              // b [rad or m]
  int first_support = 0;  // entries of Model::supports: all links between its joints and Ground, outermost first
  int support_end = 0;
};

[[nodiscard]] constexpr bool is_angle(GearKind kind, std::size_t end) noexcept {
  return kind == GearKind::gear || (kind == GearKind::rack_and_pinion && end == 0);
}

// Gears of the scene. Pre-condition: the tree has their joints. Allocates.
void add_gears(const MechanicsDef& mechanics, Model& model);

// (1) in joint coordinates; bias: part of g'' by prescribed coordinates. The gradient stays empty.
[[nodiscard]] RowValue gear_value(const Gear& gear, const Model& model, std::span<const double> q,
                                  std::span<const double> u, const Workspace& ws) noexcept;

// (1) over the velocities of links, from the motion.
struct GearRow {
  std::array<int, 4> links{};  // Ground's entries do not count; a link may occur twice
  std::array<math::Vec3, 4> v, w;
  double g = 0, rate = 0, bias = 0;
};
// near: joint coordinates; the angles continue their whole turns.
[[nodiscard]] GearRow gear_row(const Model& model, const BodyModel& body, const State& near, const Gear& gear,
                               const Workspace& ws) noexcept;

// visit(link, v, w) for every end that moves.
template <typename Visit>
void for_each_end(const GearRow& row, Visit visit) noexcept {
  for (std::size_t k = 0; k < row.links.size(); ++k) {
    if (row.links[k] > 0) visit(row.links[k], row.v[k], row.w[k]);
  }
}

// Row's force on the coordinate of an end, from the last joint_reactions(): force_on(0) on joint 1 [N or N m].
[[nodiscard]] double gear_force(const Model& model, const Workspace& ws, std::size_t gear, std::size_t end) noexcept;

// Links that the row of a gear couples, each once, without Ground. Allocates.
[[nodiscard]] std::vector<int> links_of(const Model& model, const Gear& gear);

}  // namespace slew::multibody
