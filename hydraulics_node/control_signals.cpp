// SPDX-License-Identifier: Apache-2.0
#include "hydraulics_node/control_signals.h"

#include <algorithm>

namespace slew::hydraulics_node {
namespace {

double signal(const hydraulics::Circuit& circuit, int control) noexcept {
  return circuit.control_signals()[static_cast<std::size_t>(control)];
}

}  // namespace

ControlSignals::ControlSignals(const scene::Scene& scene, const hydraulics::Circuit& circuit)
    : trends_(circuit.flow_controls().size()), present_(circuit.flow_controls().size()) {
  for (const scene::InputDef& input : scene.inputs) {
    control_of_channel_.push_back(circuit.find_control(input.primitive));
  }
}

void ControlSignals::set(std::span<const double> controls, hydraulics::Circuit& circuit) noexcept {
  const std::span<const int> flow_controls = circuit.flow_controls();
  for (std::size_t k = 0; k < flow_controls.size(); ++k) {
    static_cast<void>(trends_.begin(k, signal(circuit, flow_controls[k])));
  }
  for (std::size_t i = 0; i < std::min(controls.size(), control_of_channel_.size()); ++i) {
    if (control_of_channel_[i] >= 0) circuit.set_control(control_of_channel_[i], controls[i]);
  }
  for (std::size_t k = 0; k < flow_controls.size(); ++k) trends_.end(k, signal(circuit, flow_controls[k]));
}

void ControlSignals::foresee(hydraulics::Circuit& circuit, hydraulics::CircuitIntegrator& integrator) noexcept {
  const std::span<const int> flow_controls = circuit.flow_controls();
  bool is_any_moving = false;
  for (std::size_t k = 0; k < flow_controls.size(); ++k) {
    present_[k] = signal(circuit, flow_controls[k]);
    const double change = trends_.begin(k, present_[k]);
    if (change == 0) continue;
    circuit.set_control(flow_controls[k], present_[k] + change);
    is_any_moving = true;
  }
  if (is_any_moving) integrator.refresh_force_rates();
}

void ControlSignals::recall(hydraulics::Circuit& circuit) const noexcept {
  const std::span<const int> flow_controls = circuit.flow_controls();
  for (std::size_t k = 0; k < flow_controls.size(); ++k) circuit.set_control(flow_controls[k], present_[k]);
}

void ControlSignals::add_to(const hydraulics::Circuit& circuit, StateHash& hash) const noexcept {
  trends_.add_to(hash);
  for (const int control : circuit.flow_controls()) hash.add(signal(circuit, control));
}

}  // namespace slew::hydraulics_node
