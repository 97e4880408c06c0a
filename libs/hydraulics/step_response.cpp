// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/step_response.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/index.h"

namespace slew::hydraulics {
namespace {

const double kGamma = 1 - std::sqrt(0.5);

// share of a spring's change that a neighbour must give back within H
constexpr double kSignificant = 1e-3;

// of volumes that are not fixed and of components' states
math::SparsityPattern pattern_without_pistons(const Circuit& circuit) {
  const std::size_t n = at(circuit.state_count());
  const auto is_left = [&](std::size_t i) {
    const int index = static_cast<int>(i);
    return index < circuit.volume_count() ? !circuit.is_fixed(index) : index >= circuit.first_component_state();
  };
  math::SparsityPattern pattern(n);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = 0; k < n && is_left(i); ++k) {
      if (is_left(k) && circuit.pattern().has(i, k)) pattern.add(i, k);
    }
  }
  return pattern;
}

// (2) of a chamber alone, x = lambda H, for b = 1
struct Alone {
  double end, integral;
};
Alone alone(double x) noexcept {
  const double k_1 = 1 / (1 + kGamma * x), k_2 = (1 - (1 - kGamma) * x * k_1) / (1 + kGamma * x);
  return {(1 - kGamma) * k_1 + kGamma * k_2, 2 * kGamma * (1 - kGamma) * k_1 + kGamma * kGamma * k_2};
}

}  // namespace

StepResponse::StepResponse(const Circuit& circuit)
    : circuit_(circuit),
      n_(at(circuit.state_count())),
      is_held_(n_),
      matrix_(n_ * n_),
      lu_(pattern_without_pistons(circuit), n_),
      b_(n_),
      k_1_(n_),
      k_2_(n_),
      by_actuator_(at(circuit.actuator_count()), Response{b_, b_}),
      at_reference_{b_, b_} {
  const math::SparsityPattern pattern = pattern_without_pistons(circuit);
  for (std::size_t i = 0; i < n_; ++i) {
    for (std::size_t k = 0; k < n_; ++k) {
      if (i != k && pattern.has(i, k)) ways_.emplace_back(i, k);
    }
  }
  for (const Actuator& actuator : circuit.actuators()) {
    for (const std::size_t side : {0u, 1u}) {
      Chamber chamber{at(actuator.volume(side)), {}};
      for (const auto& [i, k] : ways_) {
        if (i == chamber.volume && pattern.has(k, i)) chamber.neighbours.push_back(k);
      }
      if (!chamber.neighbours.empty()) chambers_.push_back(std::move(chamber));
    }
  }
}

bool StepResponse::is_held(std::size_t state, const double* y, std::span<const double> C) const noexcept {
  const int index = static_cast<int>(state);
  if (index >= circuit_.volume_count()) return index < circuit_.first_component_state();
  return circuit_.is_fixed(index) || !(C[state] > 0) || circuit_.pressure(index, y).slope < 1;
}

// By chamber c and its neighbours k: sum of H^2 G_ck G_kc / (C_c C_k) over max(1, lambda_c H).
bool StepResponse::is_significant(const double* y, std::span<const double> outflow, std::span<const double> C,
                                  double H) const noexcept {
  for (const Chamber& chamber : chambers_) {
    const std::size_t c = chamber.volume;
    double sum = 0;
    for (const std::size_t k : chamber.neighbours) {
      const double both = circuit_.flow_slope(c, k) * circuit_.flow_slope(k, c);
      if (both != 0 && !is_held(k, y, C)) sum += std::fabs(both) / capacity(k, C);
    }
    const bool matters = sum * H * H > kSignificant * std::max(C[c], outflow[c] * H);
    if (matters && !is_held(c, y, C)) return true;
  }
  return false;
}

// (2) for b_
void StepResponse::respond(Response& response) noexcept {
  k_1_ = b_;
  lu_.solve(k_1_.data());
  for (std::size_t i = 0; i < n_; ++i) k_2_[i] = b_[i] - (1 - kGamma) / kGamma * (b_[i] - k_1_[i]);
  lu_.solve(k_2_.data());
  for (std::size_t i = 0; i < n_; ++i) {
    response.end[i] = (1 - kGamma) * k_1_[i] + kGamma * k_2_[i];
    response.integral[i] = 2 * kGamma * (1 - kGamma) * k_1_[i] + kGamma * kGamma * k_2_[i];
  }
}

bool StepResponse::take_part(const double* y, std::span<const double> outflow, std::span<const double> C,
                             std::span<const double> f, double H, std::span<ActuatorSprings> springs) noexcept {
  if (!is_significant(y, outflow, C, H)) return false;
  for (std::size_t i = 0; i < n_; ++i) is_held_[i] = is_held(i, y, C) ? 1 : 0;
  const double gH = kGamma * H;
  for (std::size_t i = 0; i < n_; ++i) {
    const double G = i < C.size() ? std::max(0.0, outflow[i]) : -circuit_.flow_slope(i, i);
    matrix_[i * n_ + i] = is_held_[i] != 0 ? 0 : -gH * G / capacity(i, C);
  }
  for (const auto& [i, k] : ways_) {
    const bool is_held = is_held_[i] != 0 || is_held_[k] != 0;
    matrix_[i * n_ + k] = is_held ? 0 : gH * circuit_.flow_slope(i, k) / capacity(i, C);
  }
  if (!lu_.factorise(matrix_.data(), 1)) return false;
  const auto actuators = circuit_.actuators();
  for (std::size_t j = 0; j < actuators.size(); ++j) {
    std::fill(b_.begin(), b_.end(), 0.0);
    for (const std::size_t side : {0u, 1u}) {
      const std::size_t c = at(actuators[j].volume(side));
      if (is_held_[c] == 0 && springs[j][side].K > 0) b_[c] -= actuators[j].signed_area(side, y) / C[c];
    }
    respond(by_actuator_[j]);
  }
  for (std::size_t i = 0; i < n_; ++i) b_[i] = is_held_[i] != 0 ? 0 : f[i];
  respond(at_reference_);
  for (std::size_t j = 0; j < actuators.size(); ++j) {
    for (const std::size_t side : {0u, 1u}) {
      math::RelaxingSpring& spring = springs[j][side];
      const std::size_t c = at(actuators[j].volume(side));
      if (is_held_[c] != 0 || !(spring.K > 0)) continue;
      const double s = actuators[j].signed_area(side, y);
      const Alone numeric = alone(spring.lambda * H);
      math::SpringResponse response = math::response_of(spring, H);
      response.end -= s * by_actuator_[j].end[c] + spring.K * numeric.end;
      response.integral -= s * by_actuator_[j].integral[c] + spring.K * numeric.integral;
      response.impulse += s * (at_reference_.integral[c] - f[c] * numeric.integral);
      if (response.end > 0) spring = math::spring_with(response, H, spring.K);
    }
  }
  return true;
}

double StepResponse::share_of(std::size_t actuator, std::size_t side, std::size_t other) const noexcept {
  const std::size_t c = at(circuit_.actuators()[actuator].volume(side));
  const double own = by_actuator_[actuator].end[c];
  return own != 0 ? by_actuator_[other].end[c] / own : 0;
}

}  // namespace slew::hydraulics
