// SPDX-License-Identifier: Apache-2.0
// The circuit's control signals, from the values of the session's input channels, and their expected change over the
// coming step.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/state_bytes.h"
#include "core/state_hash.h"
#include "coupling/trends.h"
#include "hydraulics/circuit.h"
#include "hydraulics/circuit_integrator.h"
#include "scene/scene.h"

namespace slew::hydraulics_node {

class ControlSignals {
 public:
  // Allocates; nothing else does.
  ControlSignals(const scene::Scene& scene, const hydraulics::Circuit& circuit);

  // Sets the signals of a step by channel.
  void set(std::span<const double> controls, hydraulics::Circuit& circuit) noexcept;
  // Computes the integrator's F_dot for the coming step, whose signals are not known yet: they continue to change as
  // before, by the limiter of coupling/trends.h, so that a jump is not continued.
  // The circuit keeps the expected signals until recall().
  void foresee(hydraulics::Circuit& circuit, hydraulics::CircuitIntegrator& integrator) noexcept;
  // Back to the present signals after foresee().
  void recall(hydraulics::Circuit& circuit) const noexcept;

  void add_to(const hydraulics::Circuit& circuit, StateHash& hash) const noexcept;
  void save(StateWriter& bytes) const { trends_.save(bytes); }
  void load(StateReader& bytes) noexcept { trends_.load(bytes); }

 private:
  std::vector<int> control_of_channel_;  // -1: the channel drives no control of this circuit
  coupling::Trends trends_;              // trends of Circuit::flow_controls(), from tick to tick
  std::vector<double> present_;          // scratch: the signals while expected ones replace them
};

}  // namespace slew::hydraulics_node
