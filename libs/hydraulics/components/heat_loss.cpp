// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/components/heat_loss.h"

#include <fmt/format.h>

#include "hydraulics/circuit_builder.h"
#include "hydraulics/component.h"
#include "hydraulics/components/shared_fields.h"
#include "hydraulics/oil_properties.h"
#include "hydraulics/passages.h"

namespace slew::hydraulics {
namespace {

constexpr Field kHeatLossFields[] = {
    field<&HeatLossDef::port_1>("port_1", port_options("volume whose oil loses heat")),
    field<&HeatLossDef::conductance>("conductance",
                                     conductance_options("heat flow per difference from the surroundings")),
    field<&HeatLossDef::surroundings_temperature>("surroundings_temperature",
                                                  surroundings_options("temperature of the surroundings")),
};

class HeatLoss final : public HydraulicComponent {
 public:
  HeatLoss(const HeatLossDef& def, CircuitBuilder& builder)
      : HydraulicComponent(def),
        def_(def),
        p_(builder.volume(def.port_1)),
        has_temperatures_(builder.def().oil_temperature == OilTemperature::by_volume) {}
  [[nodiscard]] bool has_equations() const noexcept override { return false; }
  void declare_dependencies(DependencyList&) const override {}
  void add_rates(const CircuitView&, Rates&) const noexcept override {}
  void add_jacobian(const CircuitView&, JacobianStamp&) const noexcept override {}
  void add_passages(const CircuitView&, Passages& passages) const noexcept override {
    passages.exchange(p_, def_.conductance, def_.surroundings_temperature);
  }
  void follow_oil(const PortOil& oil) noexcept override { T_ = oil.temperature(p_); }
  void list_variables(std::vector<ElementVariable>& variables) const override {
    if (has_temperatures_) variables.push_back(variable("heat", Dimension::power));
  }
  double* read_variables(const CircuitView&, double* values) const noexcept override {
    if (has_temperatures_) *values++ = def_.conductance * (T_ - def_.surroundings_temperature);
    return values;
  }
  [[nodiscard]] void* def_address() noexcept override { return &def_; }
  void apply_parameters() noexcept override {}

 private:
  HeatLossDef def_;
  StateIndex p_;
  bool has_temperatures_;
  double T_ = 0;  // K
};

void validate_heat_loss(const HydraulicsDef& circuit, const ComponentDef& component, Problems&, Problems& warnings) {
  warn_without_temperatures(circuit, component.name, "it has no effect", warnings);
}

}  // namespace

void warn_without_temperatures(const HydraulicsDef& circuit, const std::string& component, std::string_view effect,
                               Problems& warnings) {
  if (circuit.oil_temperature == OilTemperature::by_volume) return;
  warnings.push_back({component, fmt::format("the oil has one temperature, so {}", effect),
                      "hydraulics.oil_temperature: by_volume", ""});
}

ComponentType heat_loss_type() {
  return {.name = "heat_loss",
          .fields = kHeatLossFields,
          .doc = "heat of a volume's oil lost through walls to the surroundings",
          .make_def = []() -> std::unique_ptr<ComponentDef> { return std::make_unique<HeatLossDef>(); },
          .validate = validate_heat_loss,
          .build = [](const ComponentDef& def, CircuitBuilder& builder) -> std::unique_ptr<HydraulicComponent> {
            return std::make_unique<HeatLoss>(static_cast<const HeatLossDef&>(def), builder);
          }};
}

}  // namespace slew::hydraulics
