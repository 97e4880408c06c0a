// SPDX-License-Identifier: Apache-2.0
// Flows of oil and heat into the volumes of a circuit at an instant, as its components see them.
//
// A flow Q from volume j into volume i brings oil of the temperature T_j and, as heat, the work that the drop of the
// pressure does:  P_i += Q (p_j - p_i)                                                                      (1)
// Power that a shaft adds to the oil on the way is heat too, beyond that which raises the pressure. Derivation and
// limits: docs/models/hydraulics_oil_temperature.md.
#pragma once

#include <span>

#include "hydraulics/component.h"

namespace slew::hydraulics {

// Sums over what enters a volume, at an instant or integrated over a time.
struct HeatFlow {
  double inflow = 0;  // m3/s, oil and, as the flow of oil with the same effect, heat exchange
  double warm = 0;    // m3 K/s, inflow times its temperature
  double heat = 0;    // W
};

class Passages {
 public:
  // flows, contents, T: by volume; contents [m3] takes the oil that components hold beside the volume's own; view:
  // physical pressures; rho_c: J/(m3 K); work space of the size of a state.
  Passages(std::span<HeatFlow> flows, std::span<double> contents, std::span<const double> T, const CircuitView& view,
           double rho_c, std::span<double> work_space) noexcept
      : flows_(flows), contents_(contents), T_(T), view_(view), rho_c_(rho_c), work_space_(work_space) {}

  [[nodiscard]] double temperature(StateIndex volume) const noexcept { return T_[at(volume)]; }
  [[nodiscard]] double rho_c() const noexcept { return rho_c_; }

  // (1), with the power of a shaft [W]; a negative flow runs back.
  void move(StateIndex from, StateIndex to, double Q, double power = 0) noexcept {
    if (Q < 0) return move(to, from, -Q, power);
    deliver(to, Q, temperature(from), Q * (view_[from] - view_[to]) + power);
  }
  // Q >= 0 of the temperature T enters a volume, with heat [W].
  void deliver(StateIndex to, double Q, double T, double heat) noexcept {
    HeatFlow& flow = flows_[at(to)];
    flow.inflow += Q;
    flow.warm += Q * T;
    flow.heat += heat;
  }
  void add_heat(StateIndex volume, double power) noexcept { flows_[at(volume)].heat += power; }
  // Heat exchange of the conductance G [W/K] with surroundings of the temperature T.
  void exchange(StateIndex volume, double G, double T) noexcept { deliver(volume, G / rho_c_, T, 0); }
  // Oil at the volume's temperature that is not in its content [m3].
  void add_content(StateIndex volume, double V) noexcept { contents_[at(volume)] += V; }
  // The flows of the component's add_rates(), mixed, with its shaft_power().
  void mix(const HydraulicComponent& component) noexcept;

 private:
  [[nodiscard]] static std::size_t at(StateIndex i) noexcept { return static_cast<std::size_t>(i); }

  std::span<HeatFlow> flows_;
  std::span<double> contents_;
  std::span<const double> T_;
  const CircuitView& view_;
  double rho_c_;
  std::span<double> work_space_;
};

}  // namespace slew::hydraulics
