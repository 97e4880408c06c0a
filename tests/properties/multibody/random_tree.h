// Random mechanisms for property tests, the same for a seed on every run.
#pragma once

#include <random>
#include <string>
#include <vector>

#include "multibody/defs.h"
#include "multibody/state.h"
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
};

struct RandomTree {
  MechanicsDef def;
  std::vector<std::string> rows;  // forces and joints with one coordinate
  MassPoints points{};            // of the flexible bodies
};

[[nodiscard]] RandomTree random_tree(unsigned seed, const TreeOptions& options);

// Coordinates and speeds away from the start.
[[nodiscard]] State random_state(unsigned seed, const Model& model);

}  // namespace slew::multibody::testing
