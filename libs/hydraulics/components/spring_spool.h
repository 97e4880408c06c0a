// SPDX-License-Identifier: Apache-2.0
// Spool or plate on a spring, part of a valve: its delay, its orifices, and the fields of both.
//
//   tau u' = u_command - u,   tau = step_response / 3                                                           (1)
//   Q = u K root(d),   K = nominal_flow / sqrt(nominal_pressure_drop)                                           (2)
// u position or opening [1], a state; u_command and the opening of each edge are the valve's own laws. Damping
// outweighs the spool's mass: d x' + k x = A p_e with tau = d/k gives (1). Source: Merritt 1967, section 8.2.
#pragma once

#include <cmath>
#include <string_view>

#include "core/field.h"
#include "hydraulics/component.h"
#include "hydraulics/smooth.h"

namespace slew::hydraulics {

// Flow through an edge [m3/s] with its slopes over the drop [m3/s/Pa] and over the spool's position [m3/s].
struct EdgeFlow {
  double value = 0, over_drop = 0, over_position = 0;
};

class SpringSpool {
 public:
  static constexpr double kEndWidth = 0.02;    // share of the travel, smoothing of its ends
  static constexpr double kTimeConstants = 3;  // in a step response, to 95 % of the change

  // position: state u; transition: d_t of root() [Pa]
  SpringSpool(StateIndex position, double transition) noexcept : u_(position), transition_(transition) {}

  void set(double nominal_flow, double nominal_pressure_drop, double step_response) noexcept {
    K_ = nominal_flow / std::sqrt(nominal_pressure_drop);
    rate_ = kTimeConstants / step_response;
  }

  [[nodiscard]] StateIndex state() const noexcept { return u_; }
  [[nodiscard]] double K() const noexcept { return K_; }        // m3/s/sqrt(Pa)
  [[nodiscard]] double rate() const noexcept { return rate_; }  // 1/tau [1/s]
  // An opening below zero, from the solver's error, is closed; with its slope.
  [[nodiscard]] ValueSlope opening(const CircuitView& view) const noexcept {
    return {std::fmax(view[u_], 0), view[u_] > 0 ? 1.0 : 0.0};
  }

  // (1)
  void add_rate(const CircuitView& view, double command, Rates& rates) const noexcept {
    rates.set_rate(u_, rate_ * (command - view[u_]));
  }
  // Of (1), the command rises with one pressure and falls with the other; slope: of the command [1/Pa].
  void stamp_rate(StateIndex rises, StateIndex falls, double slope, JacobianStamp& jacobian) const noexcept {
    const double d = rate_ * slope;
    jacobian.add(u_, u_, -rate_);
    jacobian.add(u_, rises, d);
    jacobian.add(u_, falls, -d);
  }

  // (2) at an opening with its slope over u
  [[nodiscard]] EdgeFlow edge(const ValueSlope& opening, double drop) const noexcept {
    const ValueSlope r = root(drop, transition_);
    return {opening.value * K_ * r.value, opening.value * K_ * r.slope, opening.slope * K_ * r.value};
  }
  void stamp_edge(StateIndex from, StateIndex to, const EdgeFlow& Q, JacobianStamp& jacobian) const noexcept {
    jacobian.move(from, to, from, Q.over_drop);
    jacobian.move(from, to, to, -Q.over_drop);
    jacobian.move(from, to, u_, Q.over_position);
  }

 private:
  StateIndex u_;
  double transition_;
  double K_ = 0, rate_ = 0;
};

[[nodiscard]] constexpr FieldOptions port_options(std::string_view doc) {
  return {.presence = Presence::required, .reference = "volume", .doc = doc};
}
[[nodiscard]] constexpr FieldOptions nominal_flow_options(std::string_view doc) {
  return {.dimension = Dimension::volume_flow,
          .range = kPositive,
          .presence = Presence::required,
          .change = Change::live,
          .doc = doc};
}
inline constexpr FieldOptions kNominalPressureDrop{
    .dimension = Dimension::pressure, .range = kPositive, .doc = "pressure drop of nominal_flow"};
[[nodiscard]] constexpr FieldOptions step_response_options(std::string_view doc) {
  return {.dimension = Dimension::time, .range = kPositive, .change = Change::live, .doc = doc};
}

}  // namespace slew::hydraulics
