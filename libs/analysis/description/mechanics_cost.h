// SPDX-License-Identifier: Apache-2.0
// The calls that a step makes of a mechanism, timed alone on states of a run.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "mechanics_node/mechanics_subsystem.h"
#include "scene/scene.h"

namespace slew::analysis {

// A state of the scene's run, and the forces that act at its rows then.
struct MechanicsSample {
  multibody::State state;
  std::vector<double> port_force;  // N or N m, on the rows of the ports
};
[[nodiscard]] MechanicsSample sample(const mechanics_node::MechanicsSubsystem& mechanics, const scene::Scene& scene);

// The mechanism without a part of it. scene: one with the same bodies and joints; modes that it lacks are left out.
struct MechanicsVariant {
  const scene::Scene* scene = nullptr;
  const multibody::Model* sampled = nullptr;  // the unchanged scene, to which the samples belong
  std::string left_out;                       // contact pair
};

// ns of a communication step: means over the states.
struct MechanicsCalls {
  double evaluate = 0;  // once a sub-step
  double advance = 0;   // once a sub-step, with the rows' forces held
  double observe = 0;   // once
};
[[nodiscard]] MechanicsCalls time_mechanics(const MechanicsVariant& variant, std::span<const MechanicsSample> samples);

}  // namespace slew::analysis
