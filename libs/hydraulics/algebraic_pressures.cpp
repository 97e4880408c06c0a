// SPDX-License-Identifier: Apache-2.0
// Consistent pressures of quasi-static volumes.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "hydraulics/circuit_integrator.h"

namespace slew::hydraulics {
namespace {

constexpr int kMostCorrections = 40;  // iterations of the quasi-static pressures; steps to a far solution are halved
                                      // often
constexpr double kConsistent = 1e-3;  // share of the solver's tolerance
constexpr double kLargestCorrection = 0.5;  // share of a pressure and its scale, per iteration
constexpr int kMostSweeps = 20;             // over all quasi-static volumes
constexpr int kMostWidenings = 40;          // of a bracket, each to 1.5 or 0.5 of the pressure
constexpr int kMostHalvings = 60;           // of a bracket
constexpr int kMostMarches = 400;           // steps in time
constexpr double kMostMarch = 0.25;         // share of a pressure and its scale, per step in time
constexpr double kFirstMarch = 1e-2;        // the same, of the first step in time
constexpr double kMarched = 1e-3;           // the same, from which on Newton is tried

std::size_t place_of(StateIndex row) noexcept {
  return static_cast<std::size_t>(row);
}

}  // namespace

double CircuitIntegrator::size_of(StateIndex row) const noexcept {
  return options_.scale[place_of(row)] + std::fabs(y_[place_of(row)]);
}

// False: no pressures balance the flows, and those before stay.
bool CircuitIntegrator::make_consistent() noexcept {
  if (quasi_static_.empty()) return true;
  const auto copy = [this](std::vector<double>& pressures) {
    for (std::size_t i = 0; i < pressures.size(); ++i) pressures[i] = y_[static_cast<std::size_t>(quasi_static_[i])];
  };
  const auto put = [this](const std::vector<double>& pressures) {
    for (std::size_t i = 0; i < pressures.size(); ++i) y_[static_cast<std::size_t>(quasi_static_[i])] = pressures[i];
  };
  copy(before_);
  if (correct_by_newton()) return true;
  // where Newton finds no slope or goes in circles: the volumes one by one, which converges since every flow between
  // two volumes grows with the pressure of the first and falls with that of the second (Rheinboldt 1970)
  put(before_);
  for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
    bool is_balanced = true;
    for (const StateIndex row : quasi_static_) {
      is_balanced = is_balanced && balance(static_cast<std::size_t>(row));
    }
    if (!is_balanced) break;
    copy(balanced_);
    if (correct_by_newton()) return true;
    put(balanced_);
  }
  // where volumes that a wide opening joins must rise together, which goes slowly one by one
  put(before_);
  if (march_to_balance()) return true;
  put(before_);
  return false;
}

// The pressures as those of small volumes that fill and empty: steps of implicit Euler with one iteration each, which
// grow as the pressures come to rest. Their matrix, 1/h - J, has an inverse also where no flow has a slope.
bool CircuitIntegrator::march_to_balance() noexcept {
  const std::size_t n = quasi_static_.size();
  circuit_.rates(y_.data(), f_.data());
  double per_step = 0;  // 1/h
  for (const StateIndex row : quasi_static_) {
    per_step = std::max(per_step, std::fabs(f_[place_of(row)]) / (kFirstMarch * size_of(row)));
  }
  for (int k = 0; k < kMostMarches; ++k) {
    fill_algebraic(per_step);
    if (!algebraic_.factorise()) return false;
    algebraic_.solve({outflow_.data(), n});
    double largest = 0;
    for (std::size_t i = 0; i < n; ++i) {
      largest = std::max(largest, std::fabs(outflow_[i]) / size_of(quasi_static_[i]));
    }
    if (!std::isfinite(largest)) return false;
    per_step *= largest > kMostMarch ? 4 : 0.5;
    if (largest > kMostMarch) continue;
    for (std::size_t i = 0; i < n; ++i) y_[place_of(quasi_static_[i])] += outflow_[i];
    static_cast<void>(circuit_.bound(y_.data()));
    circuit_.rates(y_.data(), f_.data());
    if (largest > kMarched) continue;
    for (std::size_t i = 0; i < n; ++i) balanced_[i] = y_[place_of(quasi_static_[i])];
    if (correct_by_newton()) return true;
    for (std::size_t i = 0; i < n; ++i) y_[place_of(quasi_static_[i])] = balanced_[i];
    circuit_.rates(y_.data(), f_.data());
  }
  return false;
}

// 1/h - J of the quasi-static pressures and their flows over C, at the rates of the present state; flows in outflow_.
void CircuitIntegrator::fill_algebraic(double per_step) noexcept {
  const std::size_t n = quasi_static_.size();
  const auto stride = static_cast<std::size_t>(circuit_.state_count());
  const double* const J = circuit_.jacobian(y_.data(), f_.data());
  const std::span<double> a = algebraic_.matrix();
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t row = place_of(quasi_static_[i]);
    for (std::size_t j = 0; j < n; ++j) a[i * n + j] = -J[row * stride + place_of(quasi_static_[j])];
    a[i * n + i] += per_step - f_[row] * circuit_.capacity_growth(quasi_static_[i], y_.data());
    outflow_[i] = f_[row];
  }
}

// Newton on the pressures of the quasi-static volumes, all other states held, for flows that add up to zero. The rows
// are those flows over C: without the slope of C the iteration would converge to soft oil instead of balanced flows.
bool CircuitIntegrator::correct_by_newton() noexcept {
  const std::size_t n = quasi_static_.size();
  for (int k = 0; k < kMostCorrections; ++k) {
    circuit_.rates(y_.data(), f_.data());
    fill_algebraic(0);
    if (!algebraic_.factorise()) return false;
    algebraic_.solve({outflow_.data(), n});
    double largest = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const auto row = static_cast<std::size_t>(quasi_static_[i]);
      const double size = options_.scale[row] + std::fabs(y_[row]);
      if (!std::isfinite(outflow_[i])) return false;
      y_[row] += std::clamp(outflow_[i], -kLargestCorrection * size, kLargestCorrection * size);
      largest = std::max(largest, std::fabs(outflow_[i]) / size);
    }
    const bool is_bound = circuit_.bound(y_.data());
    if (largest > kConsistent * options_.relative_tolerance) continue;
    was_clamped_ = was_clamped_ || is_bound;
    return true;
  }
  return false;
}

// Pressure of one quasi-static volume at which its flows balance, by bisection with all others held: more pressure lets
// more oil out, so that the sum of the flows falls. Needs no slope, which a shut valve does not have.
bool CircuitIntegrator::balance(std::size_t row) noexcept {
  const auto inflow = [&](double pressure) {
    y_[row] = pressure;
    circuit_.rates(y_.data(), f_.data());
    return f_[row];
  };
  double below = y_[row], above = below;
  const double first = inflow(below);
  if (first == 0) return true;
  bool is_between = false;
  for (int k = 0; k < kMostWidenings && !is_between; ++k) {
    double& end = first > 0 ? above : below;
    (first > 0 ? below : above) = end;
    const double step = kLargestCorrection * (options_.scale[row] + std::fabs(end));
    y_[row] = end + (first > 0 ? step : -step);
    static_cast<void>(circuit_.bound(y_.data()));
    if (y_[row] == end) return false;
    end = y_[row];
    const double now = inflow(end);
    if (!std::isfinite(now)) return false;
    is_between = first > 0 ? now <= 0 : now >= 0;
  }
  for (int k = 0; k < kMostHalvings && is_between; ++k) {
    const double middle = below + 0.5 * (above - below);
    (inflow(middle) > 0 ? below : above) = middle;
    const double size = options_.scale[row] + std::fabs(middle);
    if (above - below <= kConsistent * options_.relative_tolerance * size) break;
  }
  y_[row] = below + 0.5 * (above - below);
  return is_between;
}

}  // namespace slew::hydraulics
