// SPDX-License-Identifier: Apache-2.0
// The same mechanism somewhere else, or written in other units: what physics must not notice.
#pragma once

#include "multibody/model/model.h"
#include "multibody/model/state.h"

namespace slew::multibody::testing {

// Everything that is fixed to Ground, gravity included, turned by R and then moved by p. Pre-condition: no element of
// elements/ and no contact.
[[nodiscard]] MechanicsDef turned_and_moved(MechanicsDef def, const math::Mat3& R, math::Vec3 p);
[[nodiscard]] State turned_and_moved(const Model& model, State state, const math::Mat3& R, math::Vec3 p);

// Factors by which the numbers of lengths, masses and times grow.
struct Units {
  double length = 1, mass = 1, time = 1;
};
[[nodiscard]] MechanicsDef in_units(MechanicsDef def, const Units& units);
[[nodiscard]] State in_units(const Model& model, State state, const Units& units);

}  // namespace slew::multibody::testing
