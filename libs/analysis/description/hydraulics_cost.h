// SPDX-License-Identifier: Apache-2.0
// The equations of a circuit and of its components, timed alone on states of a run.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace slew::analysis {

struct CircuitSample {
  std::vector<double> y;         // state of the circuit
  std::vector<double> controls;  // by input channel
};

// ns of one evaluation: means over the states.
struct CircuitCalls {
  struct Component {
    std::string name, type;
    double rates = 0, slopes = 0;
  };
  std::vector<Component> components;  // in the scene's order
  double rates = 0, slopes = 0;       // the whole circuit
};
[[nodiscard]] CircuitCalls time_circuit(const scene::Scene& scene, std::span<const CircuitSample> samples);

}  // namespace slew::analysis
