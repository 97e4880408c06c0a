// SPDX-License-Identifier: Apache-2.0
// The circuit's part of oil temperatures: heat of its components, end of a step, properties for the next one.
#include "hydraulics/oil_heat.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/index.h"
#include "hydraulics/circuit.h"

namespace slew::hydraulics {

OilHeat::OilHeat(const HydraulicsDef& def, std::size_t actuators, std::size_t states)
    : law(def),
      reference(law.at(def.reference_temperature)),
      rho_c(def.oil_density * def.oil_specific_heat),
      start_temperature(def.start_temperature),
      has_modulus(def.oil_law == OilLaw::oil_and_air),
      T(def.volumes.size(), def.start_temperature),
      friction(actuators, 0),
      power(def.volumes.size(), 0),
      properties(def.volumes.size()),
      content(def.volumes.size(), 0),
      last(def.volumes.size()),
      now(def.volumes.size()),
      sum(def.volumes.size()),
      rates(states, 0),
      unused(def.volumes.size(), 0) {
  for (const VolumeDef& volume : def.volumes) is_held.push_back(volume.fixed && volume.rigid_volume == 0 ? 1 : 0);
}

void HydraulicComponent::add_passages(const CircuitView&, Passages& passages) const noexcept {
  if (has_equations()) passages.mix(*this);
}

void Passages::mix(const HydraulicComponent& component) noexcept {
  std::fill(work_space_.begin(), work_space_.end(), 0.0);
  Rates rates(work_space_.data());
  component.add_rates(view_, rates);
  double taken = 0, delivered = 0, warm = 0, heat = component.shaft_power(view_);
  for (std::size_t i = 0; i < flows_.size(); ++i) {
    const double Q = work_space_[i];
    if (Q < 0) taken -= Q, warm -= Q * T_[i];
    if (Q > 0) delivered += Q;
    heat -= Q * view_[static_cast<StateIndex>(i)];
  }
  if (!(taken > 0 && delivered > 0)) return;
  for (std::size_t i = 0; i < flows_.size(); ++i) {
    const double Q = work_space_[i];
    if (Q > 0) deliver(static_cast<StateIndex>(i), Q, warm / taken, heat * Q / delivered);
  }
}

// Flows and heat at y into now; oil of the components is added to contents.
void Circuit::evaluate_heat(const double* y, std::vector<HeatFlow>& now, std::vector<double>& contents) noexcept {
  std::fill(now.begin(), now.end(), HeatFlow{});
  const CircuitView instant = view(y);
  evaluate_ls(instant);
  Passages passages(now, contents, heat_->T, instant, heat_->rho_c, heat_->rates);
  for (const auto& component : components_) component->add_passages(instant, passages);
  // friction heats the oil on both sides of an actuator
  for (std::size_t j = 0; j < actuators_.size(); ++j) {
    const double power = heat_->friction[j] * y[speed(static_cast<int>(j))];
    passages.add_heat(actuators_[j].port_a, 0.5 * power);
    passages.add_heat(actuators_[j].port_b, 0.5 * power);
  }
}

void Circuit::start_heat(const double* y) noexcept {
  std::fill(heat_->T.begin(), heat_->T.end(), heat_->start_temperature);
  std::fill(heat_->friction.begin(), heat_->friction.end(), 0.0);
  std::fill(heat_->power.begin(), heat_->power.end(), 0.0);
  follow_temperatures(y);
}

void Circuit::set_temperatures(std::span<const double> T, const double* y) noexcept {
  std::copy(T.begin(), T.end(), heat_->T.begin());
  follow_temperatures(y);
}

void Circuit::begin_heat(const double* y) noexcept {
  std::fill(heat_->content.begin(), heat_->content.end(), 0.0);
  evaluate_heat(y, heat_->last, heat_->content);
  for (std::size_t i = 0; i < volumes_.size(); ++i) {
    heat_->content[i] += content_at(i, y);
    heat_->sum[i] = {};
  }
}

void Circuit::add_heat(double h, const double* y) noexcept {
  evaluate_heat(y, heat_->now, heat_->unused);
  for (std::size_t i = 0; i < volumes_.size(); ++i) {
    const HeatFlow &a = heat_->last[i], &b = heat_->now[i];
    HeatFlow& sum = heat_->sum[i];
    sum.inflow += 0.5 * h * (a.inflow + b.inflow);
    sum.warm += 0.5 * h * (a.warm + b.warm);
    sum.heat += 0.5 * h * (a.heat + b.heat);
  }
  std::swap(heat_->last, heat_->now);
}

// (1)
void Circuit::end_heat(double H, const double* y) noexcept {
  for (std::size_t i = 0; i < volumes_.size(); ++i) {
    const HeatFlow& sum = heat_->sum[i];
    const double M = heat_->content[i] + sum.inflow;
    heat_->power[i] = sum.heat / H;
    if (heat_->is_held[i] != 0 || !(M > 0)) continue;
    heat_->T[i] = (heat_->content[i] * heat_->T[i] + sum.warm + sum.heat / heat_->rho_c) / M;
  }
  follow_temperatures(y);
}

void Circuit::follow_temperatures(const double* y) noexcept {
  for (std::size_t i = 0; i < volumes_.size(); ++i) {
    heat_->properties[i] = heat_->law.at(heat_->T[i]);
    if (!heat_->has_modulus) continue;
    const double offset = 1 / heat_->properties[i].bulk_modulus - 1 / heat_->reference.bulk_modulus;
    double oil = volumes_[i].volume;
    for (std::size_t k = volumes_[i].begin; k < volumes_[i].end; ++k) {
      // hoses with elastic walls have a constant content, chambers a constant wall
      if (pieces_[k].position < 0) oil += pieces_[k].volume;
      pieces_[k].wall_compressibility = heat_->piece_wall[k] + offset;
    }
    volumes_[i].wall = heat_->wall[i] + oil * offset;
  }
  const CircuitView instant = view(y);
  const PortOil oil(heat_->properties, heat_->reference, heat_->T, instant);
  for (const auto& component : components_) component->follow_oil(oil);
}

int Circuit::first_beyond_temperatures() const noexcept {
  for (std::size_t i = 0; i < volumes_.size(); ++i) {
    if (!kOilTemperatureRange.contains(heat_->T[i])) return static_cast<int>(i);
  }
  return -1;
}

void Circuit::save_heat(StateWriter& bytes) const {
  bytes.numbers(heat_->T);
  bytes.numbers(heat_->friction);
  bytes.numbers(heat_->power);
}

void Circuit::load_heat(StateReader& bytes, const double* y) noexcept {
  bytes.numbers(heat_->T);
  bytes.numbers(heat_->friction);
  bytes.numbers(heat_->power);
  const auto is_number = [](double T) { return T > 0 && std::isfinite(T); };
  if (!std::all_of(heat_->T.begin(), heat_->T.end(), is_number)) return bytes.refuse();
  follow_temperatures(y);
}

void Circuit::add_heat_to(StateHash& hash) const noexcept {
  hash.add(std::span<const double>(heat_->T));
  hash.add(std::span<const double>(heat_->friction));
}

}  // namespace slew::hydraulics
