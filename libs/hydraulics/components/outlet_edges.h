// SPDX-License-Identifier: Apache-2.0
// Two edges from two inlets into one outlet, part of a valve whose position follows the pressures at once. The openings
// are the valve's own laws, and depend on the pressures of the inlets alone.
#pragma once

#include <cmath>
#include <initializer_list>

#include "hydraulics/circuit_builder.h"
#include "hydraulics/component.h"
#include "hydraulics/components/edge_flow.h"

namespace slew::hydraulics {

class OutletEdges {
 public:
  // Def has port_1 and port_2, the inlets, and port_3, the outlet.
  template <typename Def>
  OutletEdges(const Def& def, const CircuitBuilder& builder)
      : inlets_{builder.volume(def.port_1), builder.volume(def.port_2)},
        outlet_(builder.volume(def.port_3)),
        transition_(builder.def().orifice_transition) {}

  void set(double nominal_flow, double nominal_pressure_drop) noexcept {
    K_ = nominal_flow / std::sqrt(nominal_pressure_drop);
  }

  [[nodiscard]] StateIndex inlet(int i) const noexcept { return inlets_[i]; }  // i: 0, 1
  [[nodiscard]] StateIndex outlet() const noexcept { return outlet_; }
  [[nodiscard]] double K() const noexcept { return K_; }                    // m3/s/Pa^(1/2)
  [[nodiscard]] double transition() const noexcept { return transition_; }  // Pa

  void declare_dependencies(DependencyList& dependencies) const {
    for (const StateIndex row : {inlets_[0], inlets_[1], outlet_}) {
      for (const StateIndex column : {inlets_[0], inlets_[1], outlet_}) dependencies.add(row, column);
    }
  }
  // Flow from inlet i at an opening, with its slope over what the valve's position follows.
  [[nodiscard]] EdgeFlow flow(const CircuitView& view, int i, const ValueSlope& opening) const noexcept {
    return edge_flow(opening, K_, view[inlets_[i]] - view[outlet_], transition_);
  }
  void move(int i, double flow, Rates& rates) const noexcept { rates.move(inlets_[i], outlet_, flow); }
  // Derivative of the flow from inlet i over the pressure of an inlet or, below, of the outlet.
  void stamp(int i, int over_inlet, double d, JacobianStamp& jacobian) const noexcept {
    jacobian.move(inlets_[i], outlet_, inlets_[over_inlet], d);
  }
  void stamp_outlet(int i, double d, JacobianStamp& jacobian) const noexcept {
    jacobian.move(inlets_[i], outlet_, outlet_, d);
  }

 private:
  StateIndex inlets_[2];
  StateIndex outlet_;
  double transition_;
  double K_ = 0;
};

}  // namespace slew::hydraulics
