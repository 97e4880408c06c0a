// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/oil_limits.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <span>
#include <string>
#include <string_view>

#include "core/dimension.h"

namespace slew::hydraulics {
namespace {

// A unit in which values are often known; factor to SI.
struct OtherUnit {
  std::string_view unit;
  double factor;
};

struct Limits {
  std::string_view name;
  double least, most;  // SI
  double usual;        // SI, of a mineral oil
  std::span<const OtherUnit> units;
};

// An oil's value is within this factor of the usual one.
constexpr double kUsualFactor = 5;
constexpr double kViscosityFactor = 30;  // 1.5 to 1400 mm2/s

constexpr OtherUnit kPressures[] = {{"bar", 1e5}, {"MPa", 1e6}, {"GPa", 1e9}, {"psi", 6894.757}};
constexpr OtherUnit kPerPressures[] = {{"1/bar", 1e-5}, {"1/MPa", 1e-6}, {"1/GPa", 1e-9}, {"1/psi", 1.450377e-4}};
constexpr OtherUnit kDensities[] = {{"g/cm3", 1e3}, {"lb/ft3", 16.01846}, {"kg/mm3", 1e9}};
constexpr OtherUnit kViscosities[] = {{"cSt", 1e-6}, {"St", 1e-4}};
constexpr OtherUnit kHeats[] = {{"kJ/(kg K)", 1e3}};

constexpr Limits kBulkModulus{"bulk modulus", 1e8, 1e10, 1.5e9, kPressures};
constexpr Limits kDensity{"density", 500, 2500, 870, kDensities};
constexpr Limits kViscosity{"kinematic viscosity", 1e-8, 0.02, 46e-6, kViscosities};
constexpr Limits kCompressibility{"compressibility", 1e-10, 1e-8, 6.5e-10, kPerPressures};
constexpr Limits kSpecificHeat{"specific heat", 500, 1e4, 1900, kHeats};
constexpr Limits kAirReference{"reference pressure of air", 1e3, 1e7, 1e5, kPressures};

// "15000 bar": the number in the unit that brings it nearest to the usual value; empty: none does.
std::string likely_text(const Limits& limits, double value, double widest) {
  std::string_view best;
  double nearest = std::log(widest);
  for (const OtherUnit& other : limits.units) {
    const double distance = std::fabs(std::log(value * other.factor / limits.usual));
    if (distance > nearest) continue;
    nearest = distance;
    best = other.unit;
  }
  return best.empty() ? std::string() : fmt::format("{:g} {}", value, best);
}

void check_value(const HydraulicsDef& def, double HydraulicsDef::*member, std::string_view key, const Limits& limits,
                 Problems& warnings) {
  const double value = def.*member;
  // beyond its range it is refused
  if (!(value > 0) || !std::isfinite(value) || (value >= limits.least && value <= limits.most)) return;
  std::string_view unit;
  for (const Field& field : kHydraulicsFields) {
    if (field.key == key) unit = info(field.dimension).si_unit;
  }
  const bool is_viscosity = &limits == &kViscosity;
  const std::string likely = likely_text(limits, value, is_viscosity ? kViscosityFactor : kUsualFactor);
  std::string expected = likely.empty() ? fmt::format("a value with its unit, such as '{:g} {}'", limits.usual, unit)
                                        : fmt::format("'{}' if that was meant, the value with its unit", likely);
  // a dynamic viscosity [Pa s]
  const double kinematic = value / def.oil_density;
  if (is_viscosity && std::fabs(std::log(kinematic / limits.usual)) < std::log(kUsualFactor)) {
    expected = fmt::format("'{:.3g} cSt' if {:g} Pa s was meant: the dynamic viscosity by the density", 1e6 * kinematic,
                           value);
  }
  warnings.push_back({fmt::format("hydraulics.{}", key),
                      fmt::format("{:g} {} is the {} of no hydraulic liquid ({:g} to {:g} {})", value, unit,
                                  limits.name, limits.least, limits.most, unit),
                      std::move(expected), ""});
}

}  // namespace

void find_implausible_oil(const HydraulicsDef& def, Problems& warnings) {
  const auto check = [&](double HydraulicsDef::*member, std::string_view key, const Limits& limits) {
    check_value(def, member, key, limits, warnings);
  };
  if (def.oil_law == OilLaw::oil_and_air) {
    check(&HydraulicsDef::oil_bulk_modulus, "oil_bulk_modulus", kBulkModulus);
    if (def.entrained_air > 0) check(&HydraulicsDef::air_reference_pressure, "air_reference_pressure", kAirReference);
  } else {
    check(&HydraulicsDef::oil_compressibility, "oil_compressibility", kCompressibility);
  }
  check(&HydraulicsDef::oil_density, "oil_density", kDensity);
  check(&HydraulicsDef::oil_viscosity, "oil_viscosity", kViscosity);
  if (def.oil_temperature == OilTemperature::one) return;
  check(&HydraulicsDef::oil_specific_heat, "oil_specific_heat", kSpecificHeat);
  // 0: by the usual law; the hot viscosity has rules of its own
  if (def.hot_density > 0) check(&HydraulicsDef::hot_density, "hot_density", kDensity);
  if (def.hot_bulk_modulus > 0 && def.oil_law == OilLaw::oil_and_air)
    check(&HydraulicsDef::hot_bulk_modulus, "hot_bulk_modulus", kBulkModulus);
}

}  // namespace slew::hydraulics
