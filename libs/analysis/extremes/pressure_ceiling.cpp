// SPDX-License-Identifier: Apache-2.0
#include "analysis/extremes/pressure_ceiling.h"

#include <cmath>
#include <string_view>
#include <utility>

#include "scene/parameters.h"

namespace slew::analysis {
namespace {

constexpr double kCeilingMargin = 1.1;
constexpr double kSwing = 2;  // overshoot of a load that is put on at once, relative to its rest

// take(i, W): mobility of each port that can move
template <typename Take>
void for_each_port(std::size_t ports, const coupling::MechanismSample& mechanism, Take&& take) {
  for (std::size_t i = 0; i < std::min(ports, mechanism.v.size()); ++i) {
    const double W = mechanism.W[i * mechanism.v.size() + i];
    if (W > 0) take(i, W);
  }
}

}  // namespace

PressureCeiling::PressureCeiling(const scene::Scene& scene) {
  const auto take = [](double& largest, double value) { largest = std::max(largest, value); };
  for (const scene::ParameterInfo& one : scene::parameters(scene)) {
    const std::string_view field = std::string_view(one.path).substr(one.path.rfind('.') + 1);
    if (field == "setting_pressure" || field.starts_with("shock_pressure_")) {
      take(field == "shock_pressure_rise" ? rise_ : relief_, one.value);
    }
    if (field == "opening_pressure_rise" || field == "nominal_pressure_drop") take(rise_, one.value);
    if (field == "maximum_ls_pressure" || field == "set_pressure" || field == "standby_pressure" ||
        field == "maximum_pressure")
      take(pump_, one.value);
  }
  for (const hydraulics::VolumeDef& volume : scene.hydraulics.volumes) {
    if (volume.fixed) take(tank_, volume.initial_pressure);
  }
}

void PressureCeiling::set_circuit(const hydraulics::Circuit& circuit) {
  for (const hydraulics::Relief& relief : circuit.reliefs()) relief_ = std::max(relief_, relief.fully_open);
  for (const hydraulics::Actuator& actuator : circuit.actuators()) {
    const auto [smaller, larger] = std::minmax(actuator.area_a, actuator.area_b);
    ratio_ = std::max(ratio_, larger / smaller);
    area_.push_back(smaller);
  }
  holding_.assign(area_.size(), 0);
  stopping_.assign(area_.size(), 0);
}

void PressureCeiling::follow(const coupling::MechanismSample& mechanism, const coupling::ActuatorSample& actuators) {
  for_each_port(area_.size(), mechanism, [&](std::size_t i, double W) {
    stopping_[i] = std::max(stopping_[i], std::fabs(mechanism.v[i]) * std::sqrt(actuators.K[i] / W));
  });
}

void PressureCeiling::put_on(const coupling::MechanismSample& mechanism) {
  for_each_port(area_.size(), mechanism, [&](std::size_t i, double W) {
    holding_[i] = std::max(holding_[i], kSwing * std::fabs(mechanism.a_free[i]) / W);
  });
}

double PressureCeiling::value() const {
  double by_force = 0;
  for (std::size_t i = 0; i < area_.size(); ++i) by_force = std::max(by_force, (holding_[i] + stopping_[i]) / area_[i]);
  const double source = relief_ > 0 ? relief_ + rise_ : 2 * pump_;
  return kCeilingMargin * (tank_ + ratio_ * source + by_force);
}

}  // namespace slew::analysis
