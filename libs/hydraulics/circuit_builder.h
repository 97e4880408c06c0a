// SPDX-License-Identifier: Apache-2.0
// Services for a component while the circuit is built: positions of its ports, states, content, oil data.
#pragma once

#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "hydraulics/component.h"
#include "hydraulics/hydraulics_def.h"
#include "hydraulics/staged_area.h"

namespace slew::hydraulics {

// Wall modulus min(highest, max(factor sqrt(p), lowest)) [Pa]; constant when lowest == highest, rigid when infinite.
struct WallLaw {
  double factor = 0;
  double lowest = std::numeric_limits<double>::infinity();
  double highest = std::numeric_limits<double>::infinity();
};

// Oil in a hose, chamber or block: V = volume + slope x, at least `smallest`.
struct Content {
  StateIndex volume_index = 0;
  double volume = 0;             // m3, at x = 0
  double slope = 0;              // m2, dV/dx
  StateIndex position = -1;      // position of x; -1: constant
  double smallest = 0;           // m3
  double swept_by_position = 0;  // m2, oil that leaves per x where it is not `slope`: a motor's displacement
  StateIndex setting = -1;       // state that scales swept_by_position; -1: none
  WallLaw wall = {};
  const StagedArea* stages = nullptr;  // V = volume + content of the stages at x, in the place of slope x; null: none

  // Oil that leaves the volume per x [m2], at full setting and at the state y.
  [[nodiscard]] double sweep() const noexcept { return swept_by_position != 0 ? swept_by_position : slope; }
  [[nodiscard]] double sweep_at(const double* y) const noexcept {
    if (stages != nullptr) return stages->area_at(y[position]).value;
    return setting < 0 ? sweep() : sweep() * y[setting];
  }
};

// A displacement that changes while the circuit runs: a state e scales both areas of its actuator.
struct Setting {
  StateIndex state = -1;  // e, above 0; -1: the areas are constant
  double at_start = 1;    // e that an equilibrium start assumes
};

// Areas that change with the stroke: those of a telescopic cylinder, on both sides in the same shares.
struct Stages {
  const StagedArea* area = nullptr;  // null: none
  StateIndex position = -1;

  // Share of the largest area, and its slope over the stroke [1/m].
  [[nodiscard]] ValueSlope share_at(const double* y) const noexcept {
    const ValueSlope A = area->area_at(y[position]);
    return {A.value / area->largest(), A.slope / area->largest()};
  }
};

// A brake on an actuator. Its state b is the brake's force in shares of `force`.
struct Brake {
  StateIndex state = -1;  // -1: none
  double force = 0;       // N, or Nm: greatest
};

// A cylinder as the power port sees it.
struct Actuator {
  std::string name;   // name of the component
  std::string force;  // driven force element
  StateIndex port_a = 0, port_b = 0;
  double area_a = 0, area_b = 0;   // m2; F = e (p_A area_a - p_B area_b) + b brake.force
  PortCoordinate coordinate = {};  // x = offset + ratio * element coordinate
  LineForceParameters line_force = {};
  Barrel barrel = {};
  StartRule start = StartRule::return_pressure;
  double position_scale = 1, speed_scale = 1;  // m, m/s, typical sizes
  Setting setting = {};
  Brake brake = {};
  Stages stages = {};

  // Volume of chamber A (0) or B (1), and its area at y, negative at B.
  [[nodiscard]] StateIndex volume(std::size_t side) const noexcept { return side == 0 ? port_a : port_b; }
  [[nodiscard]] double signed_area(std::size_t side, const double* y) const noexcept {
    return setting_at(y) * (side == 0 ? area_a : -area_b);
  }
  // e: share of the areas that acts at y.
  [[nodiscard]] bool has_share() const noexcept { return setting.state >= 0 || stages.area != nullptr; }
  [[nodiscard]] double setting_at(const double* y) const noexcept {
    if (stages.area != nullptr) return stages.share_at(y).value;
    return setting.state < 0 ? 1 : y[setting.state];
  }
  [[nodiscard]] double brake_at(const double* y) const noexcept {
    return brake.state < 0 ? 0 : brake.force * y[brake.state];
  }
};

// A valve that relieves a volume even if all other connections are closed.
struct Relief {
  std::string valve;  // component
  StateIndex volume = 0, outlet = 0;
  double fully_open = 0;  // Pa above the outlet
};

// Effect of a component's control signal: on flows at once, or on a state that flows follow.
enum class SignalMoves { flows, a_state };

struct ComponentState {
  double initial = 0;
  double scale = 1;  // typical size, for the error measure
};

// The shaft of an engine: its states and what its pumps need of it.
struct EngineShaft {
  std::string engine;    // component
  StateIndex speed = 0;  // in multiples of `reference`
  StateIndex fuel = 0;
  double reference = 1;  // rad/s
  double inertia = 1;    // kg m2
};

class CircuitBuilder {
 public:
  // def: validated without errors.
  explicit CircuitBuilder(const HydraulicsDef& def);

  [[nodiscard]] const HydraulicsDef& def() const noexcept { return def_; }
  [[nodiscard]] StateIndex volume(std::string_view name) const;
  [[nodiscard]] StateIndex add_state(const ComponentState& state);
  [[nodiscard]] const EngineShaft& shaft(std::string_view engine) const;
  [[nodiscard]] int add_control(std::string_view component, SignalMoves moves);
  // Number of the component's own load-sensing pressure, and of another component's.
  [[nodiscard]] LsIndex ls_index(std::string_view component) const;
  void add_content(const Content& content) { contents_.push_back(content); }
  // Index of the component's actuator; its position is y[position(index)], its speed y[speed(index)].
  [[nodiscard]] int add_actuator(const std::string& component, const ActuatorDef& actuator);
  [[nodiscard]] StateIndex position(int actuator) const noexcept { return volume_count_ + actuator; }
  [[nodiscard]] StateIndex speed(int actuator) const noexcept { return volume_count_ + actuator_count_ + actuator; }
  void set_setting(int actuator, const Setting& setting) {
    actuators_[static_cast<std::size_t>(actuator)].setting = setting;
  }
  // stages: kept by the component.
  void set_stages(int actuator, const StagedArea* stages) {
    actuators_[static_cast<std::size_t>(actuator)].stages = {stages, position(actuator)};
  }
  void set_brake(int actuator, const Brake& brake) { actuators_[static_cast<std::size_t>(actuator)].brake = brake; }
  // The volume starts at the pump pressure in an equilibrium start.
  void mark_supply(StateIndex volume) { supply_.push_back(volume); }
  void add_relief(Relief relief) { reliefs_.push_back(std::move(relief)); }

  // results, taken by the circuit
  [[nodiscard]] int state_count() const noexcept {
    return volume_count_ + 2 * actuator_count_ + static_cast<int>(states_.size());
  }
  [[nodiscard]] const std::vector<Content>& contents() const noexcept { return contents_; }
  [[nodiscard]] const std::vector<Actuator>& actuators() const noexcept { return actuators_; }
  [[nodiscard]] const std::vector<ComponentState>& states() const noexcept { return states_; }
  // In the order of their states, which come before those of all other components.
  [[nodiscard]] const std::vector<EngineShaft>& shafts() const noexcept { return shafts_; }
  [[nodiscard]] const std::vector<std::string>& controls() const noexcept { return controls_; }
  // Controls whose signal acts on flows at once.
  [[nodiscard]] const std::vector<int>& flow_controls() const noexcept { return flow_controls_; }
  [[nodiscard]] const std::vector<std::string>& ls_names() const noexcept { return ls_names_; }
  [[nodiscard]] const std::vector<StateIndex>& supply() const noexcept { return supply_; }
  [[nodiscard]] const std::vector<Relief>& reliefs() const noexcept { return reliefs_; }

 private:
  const HydraulicsDef& def_;
  int volume_count_ = 0, actuator_count_ = 0;
  std::vector<Content> contents_;
  std::vector<Actuator> actuators_;
  std::vector<ComponentState> states_;
  std::vector<EngineShaft> shafts_;
  std::vector<std::string> controls_;
  std::vector<int> flow_controls_;
  std::vector<std::string> ls_names_;
  std::vector<StateIndex> supply_;
  std::vector<Relief> reliefs_;
};

}  // namespace slew::hydraulics
