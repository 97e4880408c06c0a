// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/oil_properties.h"

#include <algorithm>
#include <cmath>

#include "hydraulics/hydraulics_def.h"

namespace slew::hydraulics {
namespace {

constexpr double kExpansion = 7e-4, kModulusFall = 4e-3;     // 1/K, of a mineral oil
constexpr double kWaltherUnit = 1e-6, kWaltherOffset = 0.7;  // m2/s, 1

// The value at hot_temperature: stated, or a share less per kelvin.
double hot(double stated, double cold, double fall, double span) noexcept {
  return stated > 0 ? stated : cold * (1 - fall * span);
}

double double_logarithm(double viscosity) noexcept {
  return std::log10(std::log10(viscosity / kWaltherUnit + kWaltherOffset));
}

}  // namespace

OilPropertyLaw::OilPropertyLaw(const HydraulicsDef& def)
    : T_1_(def.reference_temperature),
      span_(def.hot_temperature - def.reference_temperature),
      cold_{def.oil_density, def.oil_viscosity, def.oil_bulk_modulus},
      difference_{hot(def.hot_density, def.oil_density, kExpansion, span_) - def.oil_density, 0,
                  hot(def.hot_bulk_modulus, def.oil_bulk_modulus, kModulusFall, span_) - def.oil_bulk_modulus} {
  const double W_1 = double_logarithm(def.oil_viscosity), W_2 = double_logarithm(def.hot_viscosity);
  const double lg_1 = std::log10(def.reference_temperature), lg_2 = std::log10(def.hot_temperature);
  B_ = (W_1 - W_2) / (lg_2 - lg_1);
  A_ = W_1 + B_ * lg_1;
}

OilProperties OilPropertyLaw::at(double T) const noexcept {
  const double held = std::clamp(T, kOilTemperatureRange.min, kOilTemperatureRange.max);
  const double share = (held - T_1_) / span_;
  const double Z = std::pow(10, std::pow(10, A_ - B_ * std::log10(held)));
  return {.density = cold_.density + share * difference_.density,
          .viscosity = (Z - kWaltherOffset) * kWaltherUnit,
          .bulk_modulus = cold_.bulk_modulus + share * difference_.bulk_modulus};
}

}  // namespace slew::hydraulics
