// SPDX-License-Identifier: Apache-2.0
// Properties of the oil over its temperature T, from values at two temperatures.
//
//   lg lg(nu/nu_0 + 0.7) = A - B lg T,  nu_0 = 1 mm2/s              kinematic viscosity                       (1)
//   rho = rho_1 + (rho_2 - rho_1) (T - T_1)/(T_2 - T_1)             density                                   (2)
//   B = B_1 + (B_2 - B_1) (T - T_1)/(T_2 - T_1)                     bulk modulus of the oil without air       (3)
// T in K. Index 1: hydraulics.reference_temperature with oil_viscosity, oil_density, oil_bulk_modulus; index 2:
// hot_temperature with the values of the same prefix; without hot_density the density falls by 7e-4 per K, without
// hot_bulk_modulus the modulus by 4e-3 per K, as those of mineral oils do. Beyond kOilTemperatureRange the properties
// keep their values. Source: (1) Walther 1931, as in ASTM D341 for nu above 2 mm2/s. Not covered: pressure, shear, air.
#pragma once

#include <span>

#include "hydraulics/component.h"

namespace slew::hydraulics {

struct OilProperties {
  double density = 0;       // kg/m3
  double viscosity = 0;     // m2/s, kinematic
  double bulk_modulus = 0;  // Pa
};

class OilPropertyLaw {
 public:
  // def: validated.
  explicit OilPropertyLaw(const HydraulicsDef& def);
  [[nodiscard]] OilProperties at(double T) const noexcept;

 private:
  double T_1_, span_;                // K
  double A_, B_;                     // of (1)
  OilProperties cold_, difference_;  // at T_1, and from there to T_2
};

// Oil at the ports of a component, for HydraulicComponent::follow_oil().
class PortOil {
 public:
  // by_volume: properties; reference: those at the reference temperature; view: the instant.
  PortOil(std::span<const OilProperties> by_volume, const OilProperties& reference, std::span<const double> T,
          const CircuitView& view) noexcept
      : by_volume_(by_volume), reference_(reference), T_(T), view_(view) {}
  // Properties in the passage between two volumes: those of the one with the higher pressure.
  [[nodiscard]] const OilProperties& between(StateIndex a, StateIndex b) const noexcept {
    return by_volume_[static_cast<std::size_t>(view_[a] >= view_[b] ? a : b)];
  }
  // Laminar flow there over the flow at the reference temperature, (rho nu)_1/(rho nu).
  [[nodiscard]] double fluidity(StateIndex a, StateIndex b) const noexcept {
    const OilProperties& oil = between(a, b);
    return reference_.density * reference_.viscosity / (oil.density * oil.viscosity);
  }
  [[nodiscard]] double temperature(StateIndex volume) const noexcept { return T_[static_cast<std::size_t>(volume)]; }

 private:
  std::span<const OilProperties> by_volume_;
  const OilProperties& reference_;
  std::span<const double> T_;
  const CircuitView& view_;
};

}  // namespace slew::hydraulics
