// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/components/cooler.h"

#include <cmath>

#include "hydraulics/circuit_builder.h"
#include "hydraulics/component.h"
#include "hydraulics/components/heat_loss.h"
#include "hydraulics/components/shared_fields.h"
#include "hydraulics/oil.h"
#include "hydraulics/oil_properties.h"
#include "hydraulics/passages.h"
#include "hydraulics/pump_lines.h"
#include "hydraulics/smooth.h"

namespace slew::hydraulics {
namespace {

constexpr Field kCoolerFields[] = {
    field<&CoolerDef::port_1>("port_1", port_options("volume at one end")),
    field<&CoolerDef::port_2>("port_2", port_options("volume at the other end")),
    field<&CoolerDef::nominal_flow>("nominal_flow", nominal_flow_options("flow at nominal_pressure_drop")),
    field<&CoolerDef::nominal_pressure_drop>("nominal_pressure_drop", kNominalPressureDrop),
    field<&CoolerDef::conductance>("conductance", conductance_options("heat flow per difference from the coolant")),
    field<&CoolerDef::coolant_temperature>("coolant_temperature",
                                           surroundings_options("temperature of the air or water")),
};

class Cooler final : public HydraulicComponent {
 public:
  Cooler(const CoolerDef& def, CircuitBuilder& builder)
      : HydraulicComponent(def),
        def_(def),
        p_1_(builder.volume(def.port_1)),
        p_2_(builder.volume(def.port_2)),
        transition_(builder.def().orifice_transition),
        has_temperatures_(builder.def().oil_temperature == OilTemperature::by_volume),
        rho_c_(builder.def().oil_density * builder.def().oil_specific_heat) {
    apply_parameters();
  }
  void declare_dependencies(DependencyList& dependencies) const override { dependencies.add_restriction(p_1_, p_2_); }
  void add_rates(const CircuitView& view, Rates& rates) const noexcept override {
    rates.move(p_1_, p_2_, flow(view).value);
  }
  void add_jacobian(const CircuitView& view, JacobianStamp& jacobian) const noexcept override {
    const double slope = flow(view).slope;
    jacobian.move(p_1_, p_2_, p_1_, slope);
    jacobian.move(p_1_, p_2_, p_2_, -slope);
  }
  void add_passages(const CircuitView& view, Passages& passages) const noexcept override {
    const double Q = flow(view).value;
    const StateIndex from = Q < 0 ? p_2_ : p_1_, to = Q < 0 ? p_1_ : p_2_;
    const double size = std::fabs(Q), T_in = passages.temperature(from);
    passages.deliver(to, size, T_in - cooled(size, T_in), size * (view[from] - view[to]));
  }
  void follow_oil(const PortOil& oil) noexcept override {
    T_1_ = oil.temperature(p_1_);
    T_2_ = oil.temperature(p_2_);
  }
  void list_variables(std::vector<ElementVariable>& variables) const override {
    variables.push_back(variable("flow", Dimension::volume_flow));
    if (!has_temperatures_) return;
    variables.push_back(variable("heat", Dimension::power));
    variables.push_back(variable("outlet_temperature", Dimension::temperature));
  }
  double* read_variables(const CircuitView& view, double* values) const noexcept override {
    const double Q = flow(view).value, T_in = Q < 0 ? T_2_ : T_1_, fall = cooled(std::fabs(Q), T_in);
    *values++ = Q;
    if (!has_temperatures_) return values;
    *values++ = rho_c_ * std::fabs(Q) * fall;
    *values++ = T_in - fall;
    return values;
  }
  [[nodiscard]] void* def_address() noexcept override { return &def_; }
  void apply_parameters() noexcept override { K_ = def_.nominal_flow / std::sqrt(def_.nominal_pressure_drop); }

 private:
  // (1)
  [[nodiscard]] ValueSlope flow(const CircuitView& view) const noexcept {
    const ValueSlope r = root(view[p_1_] - view[p_2_], transition_);
    return {K_ * r.value, K_ * r.slope};
  }
  // T_in - T_out of (2) at a flow Q >= 0; oil that rests takes the coolant's temperature
  [[nodiscard]] double cooled(double Q, double T_in) const noexcept {
    const double passed = Q > 0 ? std::exp(-def_.conductance / (rho_c_ * Q)) : 0;
    return (T_in - def_.coolant_temperature) * (1 - passed);
  }

  CoolerDef def_;
  StateIndex p_1_, p_2_;
  double transition_;
  bool has_temperatures_;
  double rho_c_;              // J/(m3 K)
  double T_1_ = 0, T_2_ = 0;  // K, at the ports
  double K_ = 0;
};

void validate_cooler(const HydraulicsDef& circuit, const ComponentDef& component, Problems& errors,
                     Problems& warnings) {
  const CoolerDef& def = static_cast<const CoolerDef&>(component);
  check_distinct(def.name + ".port_2", def.port_1, def.port_2, errors);
  warn_without_temperatures(circuit, def.name, "it cools nothing and is a restriction", warnings);
}

}  // namespace

void CoolerDef::add_lines(PumpLines& lines) const {
  if (!(nominal_flow > 0)) return;
  lines.open.push_back(
      {port_1, port_2, nominal_flow * std::sqrt(OilCompressibility::kHighest / nominal_pressure_drop)});
}

ComponentType cooler_type() {
  return {.name = "cooler",
          .fields = kCoolerFields,
          .doc = "oil cooler in a line",
          .make_def = []() -> std::unique_ptr<ComponentDef> { return std::make_unique<CoolerDef>(); },
          .validate = validate_cooler,
          .build = [](const ComponentDef& def, CircuitBuilder& builder) -> std::unique_ptr<HydraulicComponent> {
            return std::make_unique<Cooler>(static_cast<const CoolerDef&>(def), builder);
          }};
}

}  // namespace slew::hydraulics
