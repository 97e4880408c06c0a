// SPDX-License-Identifier: Apache-2.0
// The poppet of a check valve: equations (1) to (3) of check_valves.h with their slopes, and the rules between its
// parameters.
#pragma once

#include <cmath>
#include <string>

#include "core/problem.h"
#include "hydraulics/component.h"
#include "hydraulics/components/check_valves.h"
#include "hydraulics/smooth.h"

namespace slew::hydraulics {

struct PoppetPorts {
  StateIndex inlet = 0, outlet = 0;
  StateIndex pilot = -1, back = -1;  // p_x, p_y; -1: no pilot piston
};

// Flow from inlet to outlet [m3/s] with its slopes over the pressures [m3/s/Pa].
struct PoppetFlow {
  double value = 0;
  double drop = 0;   // over p_1, and negative over p_2
  double pilot = 0;  // over p_x, and negative over p_y
};

class CheckPoppet {
 public:
  // pilot_ratio: 0 without a pilot piston; transition: d_t [Pa]
  CheckPoppet(const PoppetPorts& ports, double pilot_ratio, double transition) noexcept
      : ports_(ports), ratio_(pilot_ratio), transition_(transition) {}

  // throttle: t of (3)
  void set(const CheckParameters& common, double throttle) noexcept {
    K_ = common.nominal_flow / std::sqrt(common.nominal_pressure_drop);
    crack_ = common.crack_pressure;
    rise_ = common.opening_pressure_rise;
    throttle_ = throttle;
  }

  [[nodiscard]] double opening(const CircuitView& view) const noexcept {
    return unit_clip(lift(view), kClipWidth).value;
  }
  [[nodiscard]] PoppetFlow flow(const CircuitView& view) const noexcept {
    const double drop = view[ports_.inlet] - view[ports_.outlet];
    const ValueSlope u = unit_clip(lift(view), kClipWidth), r = root(drop, transition_);
    const double d_lift = K_ * r.value * u.slope / rise_;
    PoppetFlow Q{.value = (u.value + throttle_) * K_ * r.value, .drop = d_lift + (u.value + throttle_) * K_ * r.slope};
    if (ports_.pilot >= 0) Q.pilot = d_lift * ratio_ * push(view).slope;
    return Q;
  }
  void declare_dependencies(DependencyList& dependencies) const {
    dependencies.add_restriction(ports_.inlet, ports_.outlet);
    if (ports_.pilot < 0) return;
    for (const StateIndex row : {ports_.inlet, ports_.outlet}) {
      dependencies.add(row, ports_.pilot), dependencies.add(row, ports_.back);
    }
  }
  void stamp(const PoppetFlow& Q, JacobianStamp& jacobian) const noexcept {
    jacobian.move(ports_.inlet, ports_.outlet, ports_.inlet, Q.drop);
    jacobian.move(ports_.inlet, ports_.outlet, ports_.outlet, -Q.drop);
    if (ports_.pilot < 0) return;
    jacobian.move(ports_.inlet, ports_.outlet, ports_.pilot, Q.pilot);
    jacobian.move(ports_.inlet, ports_.outlet, ports_.back, -Q.pilot);
  }
  // flows: Rates or Passages
  template <typename Flows>
  void move(const PoppetFlow& Q, Flows& flows) const noexcept {
    flows.move(ports_.inlet, ports_.outlet, Q.value);
  }

  // near the switch of the free direction the partner gets the slope of the poppet at its full lift, the steepest
  void raise_slopes(const CircuitView& view, JacobianStamp& slopes) const noexcept {
    const double drop = view[ports_.inlet] - view[ports_.outlet], x = lift(view);
    if (drop <= 0 || std::fabs(x) > 1) return;
    const ValueSlope open = root(drop + (1 - x) * rise_, transition_);
    const double rise = K_ * open.value / rise_ + (1 + throttle_) * K_ * open.slope - flow(view).drop;
    if (rise > 0) slopes.pass(ports_.inlet, ports_.outlet, rise);
  }

 private:
  static constexpr double kClipWidth = 0.02;  // share of the lift, smoothing of the seat and of the stop

  // force of the pilot piston over its area, smooth over the opening's rise where it meets the poppet
  [[nodiscard]] ValueSlope push(const CircuitView& view) const noexcept {
    return ramp(view[ports_.pilot] - view[ports_.back], rise_);
  }
  // argument of (2)
  [[nodiscard]] double lift(const CircuitView& view) const noexcept {
    const double pilot = ports_.pilot < 0 ? 0 : ratio_ * push(view).value;
    return (view[ports_.inlet] - view[ports_.outlet] - crack_ + pilot) / rise_;
  }

  PoppetPorts ports_;
  double ratio_, transition_;
  double K_ = 0, crack_ = 0, rise_ = 1, throttle_ = 0;
};

// A rule of check valves: fully open at the nominal drop. path: of its key.
void check_nominal_drop(const std::string& path, const CheckParameters& common, Problems& errors);

}  // namespace slew::hydraulics
