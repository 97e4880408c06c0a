// SPDX-License-Identifier: Apache-2.0
// Start states of a circuit, and the volume-consistent motion of its pistons.
#include <algorithm>
#include <cmath>

#include "core/reductions.h"
#include "hydraulics/circuit.h"

namespace slew::hydraulics {
namespace {

constexpr double kLargestChange = 0.02;  // share of a pressure, per part of a piston's displacement
constexpr int kMostParts = 64;

}  // namespace

void Circuit::start_at_initial_pressures(std::span<double> y) const {
  std::copy(initial_pressure_.begin(), initial_pressure_.end(), y.begin());
  const std::size_t first = static_cast<std::size_t>(first_component_state());
  for (std::size_t k = 0; k < states_.size(); ++k) y[first + k] = states_[k].initial;
  start_components(y);
}

void Circuit::start_components(std::span<double> y) const {
  for (const HydraulicComponent* component : active_) component->start(y.data());
}

// The pressures hold what the brakes leave of the forces.
Circuit::Equilibrium Circuit::equilibrium(std::span<const double> F, std::span<const double> W,
                                          std::span<double> y) const {
  start_at_initial_pressures(y);
  start_supply(y);
  Equilibrium found{held_by_brakes(F, y.data()), {}};
  std::vector<double> by_pressure(F.begin(), F.end());
  for (std::size_t j = 0; j < by_pressure.size(); ++j) by_pressure[j] -= found.held_by_brakes[j];
  std::vector<Actuator> at_start = actuators_;
  for (Actuator& actuator : at_start) {
    if (actuator.stages.area != nullptr) actuator.setting.at_start = actuator.setting_at(y.data());
  }
  found.start = start_pressures({at_start, is_fixed_, initial_pressure_, start_return_, start_slew_}, by_pressure, W);
  for (std::size_t i = 0; i < joined_.size(); ++i) {
    if (joined_[i] < 0) continue;
    found.start.pressure[i] = found.start.pressure[static_cast<std::size_t>(joined_[i])];
    found.start.actuator[i] = found.start.actuator[static_cast<std::size_t>(joined_[i])];
  }
  return found;
}

void Circuit::start_supply(std::span<double> y) const {
  for (const StateIndex volume : supply_) {
    if (!is_fixed(volume)) y[static_cast<std::size_t>(volume)] = start_pump_;
  }
}

// Brakes take what they can of the forces, the pressures the rest.
std::vector<double> Circuit::held_by_brakes(std::span<const double> F, const double* y) const {
  const CircuitView at_start{y, control_.data(), ls_.data(), line_force_.data()};
  std::vector<double> held(actuators_.size(), 0);
  for (std::size_t j = 0; j < actuators_.size(); ++j) {
    if (braked_[j] == nullptr) continue;
    const double most = actuators_[j].brake.force * braked_[j]->brake_share(at_start);
    held[j] = std::clamp(F[j], -most, most);
  }
  return held;
}

void Circuit::start_in_equilibrium(std::span<const double> F, std::span<double> y, std::span<const double> W) const {
  const Equilibrium found = equilibrium(F, W, y);
  for (std::size_t i = 0; i < is_fixed_.size(); ++i) {
    if (found.start.actuator[i] >= 0 && is_fixed_[i] == 0) y[i] = std::max(found.start.pressure[i], floor_);
  }
  start_components(y);
  for (std::size_t j = 0; j < actuators_.size(); ++j) {
    const Brake& brake = actuators_[j].brake;
    if (brake.state >= 0) y[static_cast<std::size_t>(brake.state)] = found.held_by_brakes[j] / brake.force;
  }
}

std::vector<double> Circuit::unheld_at_start(std::span<const double> F, std::span<const double> W,
                                             std::span<const double> x) const {
  std::vector<double> y(static_cast<std::size_t>(size_));
  std::copy(x.begin(), x.end(), y.begin() + volume_count());
  return equilibrium(F, W, y).start.missing;
}

std::optional<StartDemand> Circuit::demand_beyond_limits(std::span<const double> F, std::span<const double> W,
                                                         std::span<const double> x) const {
  std::optional<StartDemand> worst;
  double farthest = 0;
  std::vector<double> y(static_cast<std::size_t>(size_));
  std::copy(x.begin(), x.end(), y.begin() + volume_count());
  const StartPressures start = equilibrium(F, W, y).start;
  for (std::size_t i = 0; i < is_fixed_.size(); ++i) {
    if (start.actuator[i] < 0 || is_fixed_[i] != 0) continue;
    StartDemand demand{static_cast<int>(i), start.actuator[i], start.pressure[i], kMostHeld, {}};
    for (const Relief& relief : reliefs_) {
      if (relief.volume != static_cast<int>(i)) continue;
      const double limit = initial_pressure_[static_cast<std::size_t>(relief.outlet)] + relief.fully_open;
      if (limit < demand.limit) demand.limit = limit, demand.valve = relief.valve;
    }
    if (demand.pressure < 0) demand.limit = 0, demand.valve = {};
    const double beyond = std::fabs(demand.pressure - demand.limit);
    const bool is_held = demand.pressure >= 0 && demand.pressure <= demand.limit;
    if (is_held || beyond <= farthest) continue;
    farthest = beyond;
    worst = demand;
  }
  return worst;
}

void Circuit::start(std::span<const double> F, std::span<double> y, std::span<const double> W) const {
  if (start_ == StartState::equilibrium) {
    start_in_equilibrium(F, y, W);
  } else {
    start_at_initial_pressures(y);
  }
}

// du/ds = -(dV/dx . dx) / C at the state y; s runs from 0 to 1 along the pistons' displacement dx.
void Circuit::chamber_rates(const double* y, double* du) const noexcept {
  for (std::size_t i = 0; i < volume_name_.size(); ++i) {
    du[i] = 0;
    if (is_fixed_[i]) continue;
    if (growth_[i] != 0) du[i] = -growth_[i] / capacity_at(i, y);
  }
}

double Circuit::brake_stiffness(int actuator, const double* y) noexcept {
  const auto j = static_cast<std::size_t>(actuator);
  return braked_[j] == nullptr ? 0 : actuators_[j].brake.force * braked_[j]->brake_grip(view(y));
}

// A brake that holds is twisted by displacement_.
void Circuit::move_brakes(double* y) noexcept {
  for (std::size_t j = 0; j < actuators_.size(); ++j) {
    if (braked_[j] == nullptr) continue;
    y[actuators_[j].brake.state] -= displacement_[j] * braked_[j]->brake_grip(view(y));
  }
}

bool Circuit::move_pistons(double* y, const double* x_new) noexcept {
  const std::size_t n = volume_name_.size(), m = actuators_.size();
  for (std::size_t j = 0; j < m; ++j) displacement_[j] = x_new[j] - y[n + j];
  // a non-finite piston leaves the pressures finite: the report names the piston's state
  if (!all_finite({x_new, m})) {
    std::copy(x_new, x_new + m, y + n);
    return false;
  }
  const bool is_within = move_lines(x_new);
  move_brakes(y);
  for (std::size_t i = 0; i < n; ++i) growth_[i] = chamber_growth(i, y);
  // parts short enough that the stiffness of oil with air changes little within one
  chamber_rates(y, slope_[0].data());
  double change = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (!vapour_.is_in(i, y)) change = std::max(change, std::fabs(slope_[0][i]) / std::max(y[i], floor_));
  }
  const double wanted = std::min(std::ceil(change / kLargestChange), static_cast<double>(kMostParts));
  const int parts = std::max(1, static_cast<int>(wanted));
  const double h = 1.0 / parts;
  for (int part = 0; part < parts; ++part) {
    // classical Runge-Kutta of order 4 along the displacement
    constexpr double kStage[] = {0, 0.5, 0.5, 1};
    // the first stage of the first part is there already
    for (std::size_t stage = part == 0 ? 1 : 0; stage < 4; ++stage) {
      for (std::size_t i = 0; i < n; ++i) {
        moved_[i] = y[i] + (stage == 0 ? 0 : kStage[stage] * h * slope_[stage - 1][i]);
      }
      for (std::size_t j = 0; j < m; ++j) moved_[n + j] = y[n + j] + kStage[stage] * h * displacement_[j];
      chamber_rates(moved_.data(), slope_[stage].data());
    }
    for (std::size_t i = 0; i < n; ++i) {
      const double moved = y[i] + h / 6 * (slope_[0][i] + 2 * slope_[1][i] + 2 * slope_[2][i] + slope_[3][i]);
      const bool crosses = vapour_.is_in(i, y) || moved < vapour_.begins_below[i];
      if (slope_[0][i] != 0 && crosses) {
        move_through_floor(i, h * growth_[i], h, y);
      } else {
        y[i] = moved;
      }
    }
    for (std::size_t j = 0; j < m; ++j) y[n + j] += h * displacement_[j];
  }
  for (std::size_t j = 0; j < m; ++j) y[n + j] = x_new[j];
  return is_within;
}

}  // namespace slew::hydraulics
