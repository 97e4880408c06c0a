// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/circuit_builder.h"

#include "core/check.h"

namespace slew::hydraulics {

CircuitBuilder::CircuitBuilder(const HydraulicsDef& def)
    : def_(def), volume_count_(static_cast<int>(def.volumes.size())) {
  for (const auto& component : def.components) {
    const ComponentType* type = find_component_type(component->type_name());
    SLEW_CHECK(type != nullptr);
    actuator_count_ += component->actuator().has_value();
    if (type->has_ls_port) ls_names_.push_back(component->name);
  }
  // shafts of engines, which pumps before and after them name
  for (const auto& component : def.components) {
    const std::optional<ShaftDef> shaft = component->shaft();
    if (!shaft) continue;
    const StateIndex speed = add_state({.initial = 1, .scale = 1}), fuel = add_state({.initial = 0, .scale = 1});
    shafts_.push_back({component->name, speed, fuel, shaft->speed, shaft->inertia});
  }
  // oil in rigid blocks
  for (int i = 0; i < volume_count_; ++i) {
    const VolumeDef& volume = def.volumes[static_cast<std::size_t>(i)];
    if (volume.rigid_volume > 0) add_content({.volume_index = i, .volume = volume.rigid_volume});
  }
}

StateIndex CircuitBuilder::volume(std::string_view name) const {
  for (int i = 0; i < volume_count_; ++i) {
    if (def_.volumes[static_cast<std::size_t>(i)].name == name) return i;
  }
  SLEW_CHECK(!"a validated circuit names existing volumes only");
  return 0;
}

StateIndex CircuitBuilder::add_state(const ComponentState& state) {
  states_.push_back(state);
  return state_count() - 1;
}

const EngineShaft& CircuitBuilder::shaft(std::string_view engine) const {
  for (const EngineShaft& shaft : shafts_) {
    if (shaft.engine == engine) return shaft;
  }
  SLEW_CHECK(!"a validated circuit names existing engines only");
  return shafts_.front();
}

int CircuitBuilder::add_control(std::string_view component, SignalMoves moves) {
  if (moves == SignalMoves::flows) flow_controls_.push_back(static_cast<int>(controls_.size()));
  controls_.emplace_back(component);
  return static_cast<int>(controls_.size()) - 1;
}

LsIndex CircuitBuilder::ls_index(std::string_view component) const {
  for (std::size_t i = 0; i < ls_names_.size(); ++i) {
    if (ls_names_[i] == component) return static_cast<LsIndex>(i);
  }
  SLEW_CHECK(!"a validated circuit names existing LS ports only");
  return 0;
}

int CircuitBuilder::add_actuator(const std::string& component, const ActuatorDef& actuator) {
  actuators_.push_back({.name = component,
                        .force = actuator.force,
                        .port_a = volume(actuator.port_a),
                        .port_b = volume(actuator.port_b),
                        .area_a = actuator.area_a,
                        .area_b = actuator.area_b,
                        .coordinate = actuator.coordinate,
                        .line_force = actuator.line_force,
                        .barrel = actuator.barrel,
                        .start = actuator.start,
                        .position_scale = actuator.position_scale,
                        .speed_scale = actuator.speed_scale});
  return static_cast<int>(actuators_.size()) - 1;
}

}  // namespace slew::hydraulics
