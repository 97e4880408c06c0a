// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/components/filter.h"

#include <fmt/format.h>

#include <cmath>

#include "hydraulics/circuit_builder.h"
#include "hydraulics/component.h"
#include "hydraulics/components/check_poppet.h"
#include "hydraulics/components/shared_fields.h"
#include "hydraulics/oil.h"
#include "hydraulics/oil_properties.h"
#include "hydraulics/pump_lines.h"

namespace slew::hydraulics {
namespace {

constexpr ReadBy kReadByBypass[] = {{"bypass_flow", "a bypass_flow above 0", [](const void* def) noexcept {
                                       return static_cast<const FilterDef*>(def)->bypass.nominal_flow > 0;
                                     }}};

constexpr Field kFilterFields[] = {
    field<&FilterDef::port_1>("port_1",
                              {.presence = Presence::required, .reference = "volume", .doc = "volume at the inlet"}),
    field<&FilterDef::port_2>("port_2",
                              {.presence = Presence::required, .reference = "volume", .doc = "volume at the outlet"}),
    field<&FilterDef::nominal_flow>("nominal_flow", {.dimension = Dimension::volume_flow,
                                                     .range = kPositive,
                                                     .presence = Presence::required,
                                                     .doc = "flow through the clean element at nominal_pressure_drop"}),
    field<&FilterDef::nominal_pressure_drop>(
        "nominal_pressure_drop",
        {.dimension = Dimension::pressure, .range = kPositive, .doc = "pressure drop of nominal_flow"}),
    field<&FilterDef::clogging>(
        "clogging", {.range = kFraction, .change = Change::live, .doc = "share of the element that dirt blocks"}),
    field<&FilterDef::bypass, &CheckParameters::nominal_flow>(
        "bypass_flow", {.dimension = Dimension::volume_flow,
                        .range = kNotNegative,
                        .doc = "flow of the open bypass valve at bypass_pressure_drop; 0: no bypass"}),
    field<&FilterDef::bypass, &CheckParameters::nominal_pressure_drop>("bypass_pressure_drop",
                                                                       {.dimension = Dimension::pressure,
                                                                        .range = kPositive,
                                                                        .read_by = kReadByBypass,
                                                                        .doc = "pressure drop of bypass_flow"}),
    field<&FilterDef::bypass, &CheckParameters::crack_pressure>("bypass_crack_pressure",
                                                                {.dimension = Dimension::pressure,
                                                                 .range = kPositive,
                                                                 .read_by = kReadByBypass,
                                                                 .doc = "pressure drop that opens the bypass"}),
    field<&FilterDef::bypass, &CheckParameters::opening_pressure_rise>(
        "bypass_opening_rise", {.dimension = Dimension::pressure,
                                .range = kPositive,
                                .read_by = kReadByBypass,
                                .doc = "rise above bypass_crack_pressure that opens the bypass fully"}),
};

class Filter final : public HydraulicComponent {
 public:
  Filter(const FilterDef& def, CircuitBuilder& builder)
      : HydraulicComponent(def),
        def_(def),
        p_1_(builder.volume(def.port_1)),
        p_2_(builder.volume(def.port_2)),
        bypass_({.inlet = p_1_, .outlet = p_2_}, 0, builder.def().orifice_transition) {
    apply_parameters();
  }

  void declare_dependencies(DependencyList& dependencies) const override { dependencies.add_restriction(p_1_, p_2_); }
  void add_rates(const CircuitView& view, Rates& rates) const noexcept override {
    rates.move(p_1_, p_2_, through_element(view));
    if (has_bypass()) bypass_.move(bypass_.flow(view), rates);
  }
  void add_jacobian(const CircuitView& view, JacobianStamp& jacobian) const noexcept override {
    jacobian.move(p_1_, p_2_, p_1_, G_);
    jacobian.move(p_1_, p_2_, p_2_, -G_);
    if (has_bypass()) bypass_.stamp(bypass_.flow(view), jacobian);
  }
  void raise_slopes(const CircuitView& view, JacobianStamp& slopes) const noexcept override {
    if (has_bypass()) bypass_.raise_slopes(view, slopes);
  }
  void list_variables(std::vector<ElementVariable>& variables) const override {
    variables.push_back(variable("flow", Dimension::volume_flow));
    variables.push_back(variable("bypass_flow", Dimension::volume_flow));
    variables.push_back(variable("pressure_drop", Dimension::pressure));
  }
  double* read_variables(const CircuitView& view, double* values) const noexcept override {
    const double bypass = has_bypass() ? bypass_.flow(view).value : 0;
    *values++ = through_element(view) + bypass;
    *values++ = bypass;
    *values++ = view[p_1_] - view[p_2_];
    return values;
  }
  void follow_oil(const PortOil& oil) noexcept override {
    fluidity_ = oil.fluidity(p_1_, p_2_);
    apply_parameters();
  }
  [[nodiscard]] void* def_address() noexcept override { return &def_; }
  void apply_parameters() noexcept override {
    G_ = fluidity_ * (1 - def_.clogging) * def_.nominal_flow / def_.nominal_pressure_drop;
    bypass_.set(def_.bypass, 0);
  }

 private:
  [[nodiscard]] bool has_bypass() const noexcept { return def_.bypass.nominal_flow > 0; }
  [[nodiscard]] double through_element(const CircuitView& view) const noexcept {
    return G_ * (view[p_1_] - view[p_2_]);
  }

  FilterDef def_;
  StateIndex p_1_, p_2_;
  CheckPoppet bypass_;
  double G_ = 0;         // m3/s/Pa
  double fluidity_ = 1;  // of the oil
};

void validate_filter(const HydraulicsDef&, const ComponentDef& component, Problems& errors, Problems&) {
  const FilterDef& def = static_cast<const FilterDef&>(component);
  check_distinct(def.name + ".port_2", def.port_1, def.port_2, errors);
  const double open = def.bypass.crack_pressure + def.bypass.opening_pressure_rise;
  if (def.bypass.nominal_flow == 0 || def.bypass.nominal_pressure_drop >= open) return;
  errors.push_back({def.name + ".bypass_pressure_drop",
                    fmt::format("at this drop the bypass is not fully open: it is from {:.6g} bar on", open * 1e-5),
                    "at least bypass_crack_pressure + bypass_opening_rise", ""});
}

}  // namespace

// The element as dirty as the scene states it, in both directions; forward the bypass beside it.
void FilterDef::add_lines(PumpLines& lines) const {
  const double element = (1 - clogging) * nominal_flow * (OilCompressibility::kHighest / nominal_pressure_drop);
  lines.open.push_back({.a = port_1, .b = port_2, .flow = element});
  if (!(bypass.nominal_flow > 0)) return;
  const double most = bypass.nominal_flow * std::sqrt(OilCompressibility::kHighest / bypass.nominal_pressure_drop);
  lines.open.push_back({.a = port_1, .b = port_2, .flow = element + most, .is_one_way = true});
}

ComponentType filter_type() {
  return {.name = "filter",
          .fields = kFilterFields,
          .doc = "filter whose element dirt may block, with or without a bypass valve",
          .make_def = []() -> std::unique_ptr<ComponentDef> { return std::make_unique<FilterDef>(); },
          .validate = validate_filter,
          .build = [](const ComponentDef& def, CircuitBuilder& builder) -> std::unique_ptr<HydraulicComponent> {
            return std::make_unique<Filter>(static_cast<const FilterDef&>(def), builder);
          }};
}

}  // namespace slew::hydraulics
