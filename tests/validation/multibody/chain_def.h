// SPDX-License-Identifier: Apache-2.0
// Chains of rods on hinges: case A11 and the extremes.
#pragma once

#include <string>

#include "multibody/model/defs.h"

namespace slew::multibody::testing {

struct ChainOptions {
  int links = 10;
  double tip_mass = 0;           // kg, a point mass at the end of the last rod
  Triple direction = {1, 0, 0};  // unit, in the plane of x and y
  double rod_mass = 1;           // kg
  double rod_length = 0.5;       // m
  Triple origin{};               // m, of the first hinge
};

// Uniform rods Rod0, Rod1, .. on hinges Hinge0, Hinge1, .. about z, in one line.
inline MechanicsDef chain_def(const ChainOptions& options) {
  MechanicsDef def;
  const auto& [x, y, z] = options.direction;
  const double l = options.rod_length, J = options.rod_mass * l * l / 12;
  const Triple center = {0.5 * l * x, 0.5 * l * y, 0}, end = {l * x, l * y, 0};
  for (int i = 0; i < options.links; ++i) {
    const std::string name = "Rod" + std::to_string(i);
    const std::string before = i == 0 ? "Ground" : "Rod" + std::to_string(i - 1);
    const Triple foot = i == 0 ? options.origin : end;
    def.bodies.push_back({.name = name,
                          .relative_to = before,
                          .position = foot,
                          .mass = options.rod_mass,
                          .center_of_mass = center,
                          .inertia = {y * y * J, x * x * J, J}});
    def.joints.push_back({.name = "Hinge" + std::to_string(i), .body1 = before, .point1 = foot, .body2 = name});
  }
  if (options.tip_mass > 0) {
    def.static_dummies.push_back({.name = "Tip",
                                  .relative_to = "Rod" + std::to_string(options.links - 1),
                                  .position = end,
                                  .mass = options.tip_mass});
  }
  return def;
}

}  // namespace slew::multibody::testing
