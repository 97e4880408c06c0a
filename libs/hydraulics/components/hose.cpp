// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/components/hose.h"

#include <cmath>
#include <numbers>
#include "hydraulics/circuit_builder.h"
#include "hydraulics/component.h"

namespace slew::hydraulics {
namespace {

constexpr Field kHoseFields[] = {
    field<&HoseDef::volume>("volume",
                            {.presence = Presence::required, .reference = "volume", .doc = "volume of the hose"}),
    field<&HoseDef::length>(
        "length",
        {.dimension = Dimension::length, .range = kPositive, .presence = Presence::required, .doc = "length"}),
    field<&HoseDef::diameter>(
        "diameter",
        {.dimension = Dimension::length, .range = kPositive, .presence = Presence::required, .doc = "inner diameter"}),
    field<&HoseDef::bulk_modulus>("bulk_modulus",
                                  {.dimension = Dimension::pressure,
                                   .range = kPositive,
                                   .doc = "modulus B_e of the wall's law min(B_max, max(B_e sqrt(p), B_min))"}),
    field<&HoseDef::minimum_bulk_modulus>(
        "minimum_bulk_modulus",
        {.dimension = Dimension::pressure, .range = kPositive, .doc = "lower bound of the wall's law"}),
    field<&HoseDef::maximum_bulk_modulus>(
        "maximum_bulk_modulus",
        {.dimension = Dimension::pressure, .range = kPositive, .doc = "upper bound of the wall's law"}),
};

constexpr double kHighestPressure = 1000e5;  // Pa, beyond the design pressure of any hose

class Hose final : public HydraulicComponent {
 public:
  Hose(const HoseDef& def, CircuitBuilder& builder) : HydraulicComponent(def), def_(def) {
    builder.add_content(
        {.volume_index = builder.volume(def.volume),
         .volume = 0.25 * std::numbers::pi * def.diameter * def.diameter * def.length,
         .wall = {
             .factor = def.bulk_modulus, .lowest = def.minimum_bulk_modulus, .highest = def.maximum_bulk_modulus}});
  }
  [[nodiscard]] bool has_equations() const noexcept override { return false; }
  void declare_dependencies(DependencyList&) const override {}
  void add_rates(const CircuitView&, Rates&) const noexcept override {}
  void add_jacobian(const CircuitView&, JacobianStamp&) const noexcept override {}
  void list_variables(std::vector<ElementVariable>&) const override {}
  double* read_variables(const CircuitView&, double* values) const noexcept override { return values; }
  [[nodiscard]] void* def_address() noexcept override { return &def_; }
  void apply_parameters() noexcept override {}

 private:
  HoseDef def_;
};

void validate_hose(const HydraulicsDef& circuit, const ComponentDef& component, Problems& errors, Problems& warnings) {
  const HoseDef& def = static_cast<const HoseDef&>(component);
  if (def.minimum_bulk_modulus > def.maximum_bulk_modulus) {
    errors.push_back({def.name + ".minimum_bulk_modulus",
                      "the lower bound of the wall's modulus is above the upper bound", "at most maximum_bulk_modulus",
                      ""});
  }
  // the wall of a hose of which nothing is known is at its upper bound at every pressure
  if (def.bulk_modulus == HoseDef{}.bulk_modulus) return;
  const double highest_rise = def.bulk_modulus * std::sqrt(kHighestPressure);
  if (def.minimum_bulk_modulus == def.maximum_bulk_modulus || highest_rise <= def.minimum_bulk_modulus) {
    warnings.push_back({def.name + ".bulk_modulus",
                        "the wall's modulus is at its lower bound at every pressure, so this value has no effect",
                        "a value above minimum_bulk_modulus / sqrt(pressure), and two different bounds", ""});
    return;
  }
  // the law is at its cap even at the lowest pressure
  if (def.bulk_modulus * std::sqrt(circuit.pressure_floor) >= def.maximum_bulk_modulus) {
    warnings.push_back({def.name + ".bulk_modulus",
                        "the wall's modulus is at its upper bound at every pressure, so this value has no effect",
                        "a value below maximum_bulk_modulus / sqrt(pressure)", ""});
  }
}

}  // namespace

ComponentType hose_type() {
  return {.name = "hose",
          .fields = kHoseFields,
          .doc = "hose or pipe: oil volume with an elastic wall",
          .make_def = []() -> std::unique_ptr<ComponentDef> { return std::make_unique<HoseDef>(); },
          .validate = validate_hose,
          .build = [](const ComponentDef& def, CircuitBuilder& builder) -> std::unique_ptr<HydraulicComponent> {
            return std::make_unique<Hose>(static_cast<const HoseDef&>(def), builder);
          }};
}

}  // namespace slew::hydraulics
