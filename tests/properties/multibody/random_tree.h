// SPDX-License-Identifier: Apache-2.0
// Random mechanisms for property tests, the same for a seed on every run.
#pragma once

#include <random>
#include <string>
#include <vector>

#include "multibody/model/defs.h"
#include "multibody/model/state.h"
#include "tests/properties/multibody/random_modes.h"

namespace slew::multibody::testing {

struct TreeOptions {
  int bodies = 6;
  bool only_one_coordinate = false;  // revolute and prismatic joints
  bool with_forces = true;           // spring-dampers
  bool with_dummies = true;
  bool with_gravity = true;
  bool lines_to_ground = true;   // forces between bodies and Ground as well
  bool two_coordinates = false;  // universal and cylindrical joints as well
  bool floating_root = false;    // the first body floats, no other joint reaches Ground
  bool with_modes = false;       // some bodies are flexible
  bool with_shortening = false;  // and stiffen by bending
};

// Seeds from here on have flexible bodies in the tests of trees, then those with geometric stiffening, then those with
// dummies at the nodes of flexible bodies, and with both.
inline constexpr unsigned kFirstWithModes = 101, kFirstWithShortening = 201, kFirstWithNodeDummies = 301,
                          kFirstWithBoth = 401;

// The same options with flexible bodies for such a seed.
[[nodiscard]] inline TreeOptions with_modes_of(unsigned seed, TreeOptions options) {
  options.with_modes = seed >= kFirstWithModes;
  options.with_shortening = (seed >= kFirstWithShortening && seed < kFirstWithNodeDummies) || seed >= kFirstWithBoth;
  if (options.with_modes) options.with_dummies = seed >= kFirstWithNodeDummies;
  return options;
}

struct RandomTree {
  MechanicsDef def;
  std::vector<std::string> rows;  // forces and joints with one coordinate
  MassPoints points{};            // mass points of the flexible bodies
};

[[nodiscard]] RandomTree random_tree(unsigned seed, const TreeOptions& options);

// Coordinates and speeds away from the start.
[[nodiscard]] State random_state(unsigned seed, const Model& model);

}  // namespace slew::multibody::testing
