// SPDX-License-Identifier: Apache-2.0
// Start states of a circuit, and the volume-consistent motion of its pistons.
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/reductions.h"
#include "hydraulics/circuit.h"

namespace slew::hydraulics {
namespace {

constexpr double kLowestStart = 1e5;     // Pa; below it an anti-cavitation valve would be open from the start
constexpr double kLargestChange = 0.02;  // share of a pressure, per part of a piston's displacement
constexpr int kMostParts = 64;

struct Pair {
  double a, b;
};

// Pressures that hold F; b is `aim`, or higher if a would be too low.
Pair held_by_return_side(const Actuator& actuator, double F, double aim) noexcept {
  Pair p{(F + aim * actuator.area_b) / actuator.area_a, aim};
  if (p.a < kLowestStart && actuator.area_b > 0) {
    p.a = kLowestStart;
    p.b = (p.a * actuator.area_a - F) / actuator.area_b;
  }
  return p;
}

// Pressures that hold F around `mean`, which is raised if one would be too low.
Pair held_around_mean(const Actuator& actuator, double F, double mean) noexcept {
  const double half = F / (actuator.area_a + actuator.area_b);
  mean = std::max(mean, kLowestStart + std::fabs(half));
  return {mean + half, mean - half};
}

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

std::vector<Circuit::Asked> Circuit::asked_in_equilibrium(std::span<const double> F) const {
  std::vector<Asked> asked(volume_name_.size());
  for (std::size_t j = 0; j < actuators_.size(); ++j) {
    const Actuator& actuator = actuators_[j];
    const std::size_t a = static_cast<std::size_t>(actuator.port_a), b = static_cast<std::size_t>(actuator.port_b);
    Pair p = actuator.start == StartRule::return_pressure ? held_by_return_side(actuator, F[j], start_return_)
                                                          : held_around_mean(actuator, F[j], start_slew_);
    // a chamber on a fixed volume keeps its pressure, the other one holds
    if (is_fixed_[b]) p.a = (F[j] + initial_pressure_[b] * actuator.area_b) / actuator.area_a;
    if (is_fixed_[a] && actuator.area_b > 0) p.b = (initial_pressure_[a] * actuator.area_a - F[j]) / actuator.area_b;
    for (const auto& [volume, pressure] : {std::pair(a, p.a), std::pair(b, p.b)}) {
      asked[volume].sum += pressure;
      ++asked[volume].actuators;
      asked[volume].last = static_cast<int>(j);
    }
  }
  return asked;
}

void Circuit::start_in_equilibrium(std::span<const double> F, std::span<double> y) const {
  start_at_initial_pressures(y);
  for (const StateIndex volume : supply_) {
    if (!is_fixed(volume)) y[static_cast<std::size_t>(volume)] = start_pump_;
  }
  // a volume shared by several cylinders takes the mean of the required pressures
  const std::vector<Asked> asked = asked_in_equilibrium(F);
  for (std::size_t i = 0; i < asked.size(); ++i) {
    if (asked[i].actuators > 0 && is_fixed_[i] == 0) y[i] = std::max(asked[i].pressure(), floor_);
  }
  start_components(y);
}

std::optional<StartDemand> Circuit::demand_beyond_limits(std::span<const double> F) const {
  std::optional<StartDemand> worst;
  double farthest = 0;
  const std::vector<Asked> asked = asked_in_equilibrium(F);
  for (std::size_t i = 0; i < asked.size(); ++i) {
    if (asked[i].actuators == 0 || is_fixed_[i] != 0) continue;
    StartDemand demand{static_cast<int>(i), asked[i].last, asked[i].pressure(), kMostHeld, {}};
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

void Circuit::start(std::span<const double> F, std::span<double> y) const {
  if (start_ == StartState::equilibrium) {
    start_in_equilibrium(F, y);
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

bool Circuit::move_pistons(double* y, const double* x_new) noexcept {
  const std::size_t n = volume_name_.size(), m = actuators_.size();
  for (std::size_t j = 0; j < m; ++j) displacement_[j] = x_new[j] - y[n + j];
  // a non-finite piston leaves the pressures finite: the report names the piston's state
  if (!all_finite({x_new, m})) {
    std::copy(x_new, x_new + m, y + n);
    return false;
  }
  const bool is_within = move_lines(x_new);
  for (std::size_t i = 0; i < n; ++i) growth_[i] = chamber_growth(i);
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
    for (std::size_t stage = 0; stage < 4; ++stage) {
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
