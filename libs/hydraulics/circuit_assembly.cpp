// SPDX-License-Identifier: Apache-2.0
// A circuit is assembled once: its components in the order of the definition, contents of volumes, the order of the
// load-sensing pressures, the pattern of the Jacobian, variables and parameters.
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/check.h"
#include "core/index.h"
#include "hydraulics/circuit.h"
#include "hydraulics/start_volumes.h"

namespace slew::hydraulics {
namespace {

constexpr double kNearFloor = 2;          // in pressure scales: range where air makes oil soft
constexpr double kNominalContent = 1e-6;  // m3, of a quasi-static volume without content

}  // namespace

Circuit::Circuit(const HydraulicsDef& def)
    : oil_(def),
      floor_(def.pressure_floor),
      kappa_at_floor_(oil_.at(def.pressure_floor).value),
      near_floor_(def.pressure_floor + kNearFloor * def.pressure_scale),
      content_at_floor_(oil_.content(def.pressure_floor)),
      start_(def.start),
      start_return_(def.start_return_pressure),
      start_slew_(def.start_slew_pressure),
      start_pump_(def.start_pump_pressure) {
  CircuitBuilder builder(def);
  for (const EngineShaft& shaft : builder.shafts()) state_owner_.insert(state_owner_.end(), 2, shaft.engine);
  for (const auto& component : def.components) {
    components_.push_back(find_component_type(component->type_name())->build(*component, builder));
    if (components_.back()->has_equations()) active_.push_back(components_.back().get());
    state_owner_.resize(builder.states().size(), component->name);
  }
  size_ = builder.state_count();
  for (const VolumeDef& volume : def.volumes) {
    volume_name_.push_back(volume.name);
    is_fixed_.push_back(volume.fixed ? 1 : 0);
    initial_pressure_.push_back(volume.initial_pressure);
    vapour_.begins_below.push_back(volume.fixed ? -std::numeric_limits<double>::infinity() : floor_);
  }
  actuators_ = builder.actuators();
  braked_.assign(actuators_.size(), nullptr);
  for (const auto& component : components_) {
    for (std::size_t j = 0; j < actuators_.size(); ++j) {
      if (actuators_[j].brake.state >= 0 && actuators_[j].name == component->name()) braked_[j] = component.get();
    }
  }
  states_ = builder.states();
  control_name_ = builder.controls();
  flow_controls_ = builder.flow_controls();
  supply_ = builder.supply();
  joined_ = joined_to_actuators(def);
  reliefs_ = builder.reliefs();
  add_contents(builder);
  list_rigid_contents();

  scale_.assign(at(volume_count()), def.pressure_scale);
  for (const Actuator& actuator : actuators_) scale_.push_back(actuator.position_scale);
  for (const Actuator& actuator : actuators_) scale_.push_back(actuator.speed_scale);
  for (const ComponentState& state : states_) scale_.push_back(state.scale);
  relative_.assign(at(size_), 1);
  for (int j = 0; j < actuator_count(); ++j) relative_[at(position(j))] = 0;
  relative_below_zero_ = relative_;
  std::fill_n(relative_below_zero_.begin(), volume_count(), 0.0);

  control_.assign(control_name_.size(), 0);
  line_force_.assign(actuators_.size(), 0);
  ls_.assign(builder.ls_names().size(), 0);
  jacobian_.assign((at(size_) + ls_.size()) * at(size_), 0);
  moved_.assign(at(size_), 0);
  displacement_.assign(actuators_.size(), 0);
  growth_.assign(at(volume_count()), 0);
  physical_.assign(at(size_), 0);
  kept_.assign(at(size_), 0);
  kept_rates_.assign(at(size_), 0);
  for (std::vector<double>& k : slope_) k.assign(at(volume_count()), 0);
  for (std::size_t i = 0; i < volumes_.size(); ++i) vapour_.capacity.push_back(capacity_at_floor(i, moved_.data()));
  order_ls_sources(builder);
  declare_pattern();
  if (def.oil_temperature == OilTemperature::by_volume) make_heat(def);
  list_variables();
  list_parameters();
}

// Temperatures, with the properties at the initial pressures.
void Circuit::make_heat(const HydraulicsDef& def) {
  heat_ = std::make_unique<OilHeat>(def, actuators_.size(), at(size_));
  for (const VolumeContent& volume : volumes_) heat_->wall.push_back(volume.wall);
  for (const Piece& piece : pieces_) heat_->piece_wall.push_back(piece.wall_compressibility);
  std::vector<double> y(at(size_), 0);
  std::copy(initial_pressure_.begin(), initial_pressure_.end(), y.begin());
  start_heat(y.data());
}

void Circuit::add_contents(const CircuitBuilder& builder) {
  for (int i = 0; i < volume_count(); ++i) {
    VolumeContent volume{.begin = pieces_.size()};
    for (const Content& content : builder.contents()) {
      if (content.volume_index != i) continue;
      Piece piece{content};
      // a law at its cap at any pressure, or without one, is a constant
      const WallLaw& wall = content.wall;
      piece.has_constant_wall =
          wall.lowest >= wall.highest || wall.factor * std::sqrt(oil_.lowest_pressure()) >= wall.highest;
      piece.wall_compressibility = 1 / wall.highest;
      if (piece.position < 0 && piece.has_constant_wall) {
        volume.volume += content.volume;
        volume.wall += content.volume * piece.wall_compressibility;
      } else {
        pieces_.push_back(piece);
      }
    }
    volume.end = pieces_.size();
    // validated: quasi-static, and its row is the flows over a capacity
    if (volume.volume == 0 && volume.end == volume.begin && !is_fixed_[static_cast<std::size_t>(i)]) {
      volume.nominal = kNominalContent;
    }
    const auto is_chamber = [](const Piece& piece) { return piece.position >= 0; };
    if (std::any_of(pieces_.begin() + static_cast<std::ptrdiff_t>(volume.begin), pieces_.end(), is_chamber)) {
      with_chambers_.push_back(static_cast<std::size_t>(i));
    }
    volumes_.push_back(volume);
  }
  lines_.resize(2 * actuators_.size());
  for (std::size_t k = 0; k < pieces_.size(); ++k) {
    const Piece& piece = pieces_[k];
    if (piece.position < 0) continue;
    const int actuator = piece.position - volume_count();
    lines_[2 * at(actuator) + (piece.sweep() > 0 ? 0 : 1)] = {.volume = piece.volume_index,
                                                              .position = piece.position,
                                                              .speed = piece.position + actuator_count(),
                                                              .slope = piece.sweep(),
                                                              .piece = k};
  }
}

void Circuit::order_ls_sources(const CircuitBuilder& builder) {
  std::vector<HydraulicComponent*> source;
  for (const std::string& name : builder.ls_names()) {
    for (const auto& component : components_) {
      if (component->name() == name) source.push_back(component.get());
    }
  }
  // take components whose inputs are all ordered, until none is left; a validated chain has no loop
  std::vector<char> is_ordered(source.size(), 0);
  while (ls_order_.size() < source.size()) {
    const std::size_t before = ls_order_.size();
    for (std::size_t i = 0; i < source.size(); ++i) {
      if (is_ordered[i]) continue;
      const std::vector<LsIndex> inputs = source[i]->ls_inputs();
      if (std::any_of(inputs.begin(), inputs.end(), [&](LsIndex k) { return !is_ordered[at(k)]; })) continue;
      is_ordered[i] = 1;
      ls_order_.push_back({source[i], static_cast<LsIndex>(i)});
    }
    SLEW_CHECK(ls_order_.size() > before);
  }
}

void Circuit::declare_pattern() {
  // rows of the load-sensing pressures first, in their order; then the equations
  math::SparsityPattern with_ls(at(size_) + ls_.size());
  DependencyList dependencies(with_ls, size_);
  for (const LsSource& source : ls_order_) source.component->declare_ls_dependencies(dependencies);
  for (const HydraulicComponent* component : active_) component->declare_dependencies(dependencies);
  for (const Piece& piece : pieces_) {
    if (piece.position >= 0) dependencies.add(piece.volume_index, piece.position);
  }
  for (int j = 0; j < actuator_count(); ++j) dependencies.add(position(j), speed(j));
  pattern_ = math::SparsityPattern(at(size_));
  for (int i = 0; i < size_; ++i) {
    for (int j = 0; j < size_; ++j) {
      // a fixed volume never changes: neither its row nor its column takes part in an elimination
      const bool is_held = (i < volume_count() && is_fixed(i)) || (j < volume_count() && is_fixed(j));
      if (!is_held && with_ls.has(at(i), at(j))) pattern_.add(at(i), at(j));
    }
  }
}

void Circuit::list_variables() {
  for (const std::string& name : volume_name_) {
    variables_.push_back({name + ".pressure", Dimension::pressure});
    variables_.push_back({name + ".content", Dimension::volume});
    variables_.push_back({name + ".effective_bulk_modulus", Dimension::pressure});
    variables_.push_back({name + ".is_cavitating", Dimension::none});
    if (!has_temperatures()) continue;
    variables_.push_back({name + ".temperature", Dimension::temperature});
    variables_.push_back({name + ".viscosity", Dimension::kinematic_viscosity});
    variables_.push_back({name + ".heat", Dimension::power});
  }
  for (const auto& component : components_) component->list_variables(variables_);
}

void Circuit::list_parameters() {
  for (std::size_t i = 0; i < components_.size(); ++i) {
    HydraulicComponent& component = *components_[i];
    for (const Field& row : component.type().fields) {
      if (row.change != Change::live || row.type != FieldType::number) continue;
      double* const value = static_cast<double*>(row.member(component.def_address()));
      parameters_.push_back({component.name() + "." + std::string(row.key), &row, value, i});
      parameter_value_.push_back(*value);
    }
  }
}

}  // namespace slew::hydraulics
