// SPDX-License-Identifier: Apache-2.0
// Chains of n links with hinges about x and y in turn, for the cost of an additional link.
#pragma once

#include <cmath>
#include <string>

#include "multibody/model/defs.h"

namespace slew::multibody::testing {

struct ChainOptions {
  double first_angle = 0;      // rad, turn of the first hinge about x
  double initial_speed = 0.1;  // rad/s, of every hinge
};

// Links of 0.5 m and 1 kg, hanging straight down -z from the first one's end at the origin.
inline MechanicsDef chain_def(int n, const ChainOptions& options = {}) {
  MechanicsDef def;
  std::string parent = "Ground";
  for (int i = 0; i < n; ++i) {
    const std::string name = "L" + std::to_string(i);
    const Triple point = {0, 0, i == 0 ? 0.0 : -0.5};
    def.bodies.push_back({.name = name,
                          .relative_to = parent,
                          .position = point,
                          .orientation = {0, i == 0 ? options.first_angle : 0.0, 0},
                          .mass = 1,
                          .center_of_mass = {0, 0, -0.25},
                          .inertia = {0.03, 0.03, 0.002}});
    const Triple axis = i % 2 == 0 ? Triple{0, M_PI / 2, 0} : Triple{-M_PI / 2, 0, 0};
    def.joints.push_back({.name = "J" + std::to_string(i),
                          .body1 = parent,
                          .point1 = point,
                          .orientation1 = axis,
                          .body2 = name,
                          .orientation2 = axis,
                          .initial_velocity = options.initial_speed});
    parent = name;
  }
  return def;
}

}  // namespace slew::multibody::testing
