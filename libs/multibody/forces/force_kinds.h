// SPDX-License-Identifier: Apache-2.0
// The table of force kinds beyond spring-dampers, and the loops over it. A new kind: its header and its row.
//
// Kinds are walked in the order of the table, each in the scene's order: so are wrenches summed, parameters hashed and
// variables listed. A kind that a scene does not have costs the look at an empty array.
#pragma once

#include <tuple>

#include "multibody/forces/beam.h"
#include "multibody/forces/bushing.h"
#include "multibody/forces/point_load.h"
#include "multibody/forces/rope.h"
#include "multibody/forces/tyre.h"

namespace slew::multibody {

template <typename... Rows>
struct ForceTable {
  struct Defs : Rows::Defs... {};          // lists of MechanicsDef
  struct Elements : Rows::Elements... {};  // lists of ElementSet

  template <typename Visit>
  static void for_each_row(Visit&& visit) {
    (visit(Rows()), ...);
  }
};

using ForceKinds = ForceTable<PointLoadRow, BushingRow, BeamRow, RopeRow, TyreRow>;

// visit(row) for every row; row: an empty object of its type.
template <typename Visit>
void for_each_force_kind(Visit&& visit) {
  ForceKinds::for_each_row(visit);
}

// visit(row, type, defs) for every type of every kind. lists: a MechanicsDef, const or not.
template <typename Lists, typename Visit>
void for_each_force_type(Lists& lists, Visit&& visit) {
  for_each_force_kind([&](auto row) {
    std::apply([&](const auto&... type) { (visit(row, type, lists.*type.list), ...); }, decltype(row)::kTypes);
  });
}

}  // namespace slew::multibody
