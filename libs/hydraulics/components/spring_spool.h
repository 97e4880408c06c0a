// SPDX-License-Identifier: Apache-2.0
// Spool or plate on a spring, part of a valve: its delay and its edges.
//
//   tau u' = u_command - u,   tau = step_response / 3                                                           (1)
// u position or opening [1], a state; u_command and the opening of each edge are the valve's own laws. Damping
// outweighs the spool's mass: d x' + k x = A p_e with tau = d/k gives (1). Source: Merritt 1967, section 8.2.
#pragma once

#include <cmath>

#include "hydraulics/component.h"
#include "hydraulics/components/edge_flow.h"
#include "hydraulics/smooth.h"

namespace slew::hydraulics {

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

  // at an opening with its slope over u
  [[nodiscard]] EdgeFlow edge(const ValueSlope& opening, double drop) const noexcept {
    return edge_flow(opening, K_, drop, transition_);
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

}  // namespace slew::hydraulics
