// SPDX-License-Identifier: Apache-2.0
// The parts of a scene, its number of states, and its nodes with reasons.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/json.h"
#include "multibody/model/defs.h"
#include "scene/scene.h"

namespace slew::analysis {

// A body's inertia, and the mesh or the shapes that it was computed from.
struct BodyNumbers {
  multibody::BodyDef def;
  std::optional<scene::SolidInertia> solid;
};

struct NodeNeed {
  std::string role;
  bool is_needed = false;
  std::string reason;
};

struct Description {
  std::string name, text;
  double step = 0, duration = 0;
  std::string pace;
  std::vector<BodyNumbers> body_numbers;
  std::size_t bodies = 0, joints = 0, links = 0, rows = 0;
  int degrees_of_freedom = 0;
  std::vector<std::string> motions;   // "Body_Pillar (revolute, 1)"
  std::vector<std::string> flexible;  // "Boom: 2 modes ..."
  std::vector<std::string> driven;    // "Crank_Drive (Crank_Pin, angle)": prescribed motions
  std::vector<std::string> gears;     // "Slew_Gear (Pinion_Axis, Slew_Joint)"
  std::vector<std::string> closed;    // "Coupler (revolute_revolute, 1 row)": joints outside of the tree
  std::vector<std::string> merged;    // "Pole with Pillar"
  std::vector<std::string> contacts;  // pairs that are tested
  std::size_t components = 0, free_volumes = 0, fixed_volumes = 0;
  int hydraulic_states = 0;
  std::vector<std::string> ports;   // "Cyl_Lift drives ForceT_Lift"
  std::vector<std::string> inputs;  // "Input_Lift moves L90Lift"
  std::vector<NodeNeed> nodes;
  std::vector<std::string> left_out;
};

// Builds the model and the circuit of the scene for it.
[[nodiscard]] Description describe(const scene::Scene& scene);

// width [characters]: of the lines of the table; 0: no limit.
[[nodiscard]] std::string report_text(const Description& description, std::size_t width = 0);
[[nodiscard]] Json report_json(const Description& description);

}  // namespace slew::analysis
