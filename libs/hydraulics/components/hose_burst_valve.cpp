// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/components/hose_burst_valve.h"

#include <cmath>

#include "hydraulics/circuit_builder.h"
#include "hydraulics/component.h"
#include "hydraulics/components/shared_fields.h"
#include "hydraulics/components/spring_spool.h"
#include "hydraulics/oil.h"
#include "hydraulics/oil_properties.h"
#include "hydraulics/pump_lines.h"
#include "hydraulics/smooth.h"

namespace slew::hydraulics {
namespace {

constexpr Field kHoseBurstValveFields[] = {
    field<&HoseBurstValveDef::port_1>("port_1", port_options("volume at the hose")),
    field<&HoseBurstValveDef::port_2>("port_2", port_options("volume at the load")),
    field<&HoseBurstValveDef::nominal_flow>("nominal_flow", {.dimension = Dimension::volume_flow,
                                                             .range = kPositive,
                                                             .presence = Presence::required,
                                                             .doc = "flow of the open valve at nominal_pressure_drop"}),
    field<&HoseBurstValveDef::nominal_pressure_drop>("nominal_pressure_drop", kNominalPressureDrop),
    field<&HoseBurstValveDef::closing_flow>("closing_flow", {.dimension = Dimension::volume_flow,
                                                             .range = kPositive,
                                                             .presence = Presence::required,
                                                             .change = Change::live,
                                                             .doc = "flow out of the load that begins to shut it"}),
    field<&HoseBurstValveDef::closing_pressure_rise>(
        "closing_pressure_rise",
        {.dimension = Dimension::pressure, .range = kPositive, .doc = "rise above the drop of closing_flow to shut"}),
    field<&HoseBurstValveDef::step_response>("step_response",
                                             step_response_options("three time constants of the opening")),
    field<&HoseBurstValveDef::leak_flow>("leak_flow", {.dimension = Dimension::volume_flow,
                                                       .range = kNotNegative,
                                                       .change = Change::live,
                                                       .doc = "leak of the shut valve at leak_pressure"}),
    field<&HoseBurstValveDef::leak_pressure>(
        "leak_pressure",
        {.dimension = Dimension::pressure, .range = kPositive, .doc = "pressure difference of the leak flows"}),
};

class HoseBurstValve final : public HydraulicComponent {
 public:
  HoseBurstValve(const HoseBurstValveDef& def, CircuitBuilder& builder)
      : HydraulicComponent(def),
        def_(def),
        p_1_(builder.volume(def.port_1)),
        p_2_(builder.volume(def.port_2)),
        u_(builder.add_state({.initial = 1, .scale = 1})),
        plate_(u_, builder.def().orifice_transition) {
    apply_parameters();
  }
  // at rest, shut where the load's pressure is higher already
  void start(double* y) const noexcept override { y[u_] = target(y[p_2_] - y[p_1_]).value; }
  void declare_dependencies(DependencyList& dependencies) const override {
    dependencies.add_restriction(p_1_, p_2_);
    for (const StateIndex port : {p_1_, p_2_}) dependencies.add(port, u_), dependencies.add(u_, port);
    dependencies.add(u_, u_);
  }
  void add_rates(const CircuitView& view, Rates& rates) const noexcept override {
    plate_.add_rate(view, target(drop(view)).value, rates);
    rates.move(p_2_, p_1_, flow(view).value);
  }
  void add_jacobian(const CircuitView& view, JacobianStamp& jacobian) const noexcept override {
    plate_.stamp_rate(p_2_, p_1_, target(drop(view)).slope, jacobian);
    plate_.stamp_edge(p_2_, p_1_, flow(view), jacobian);
  }
  void list_variables(std::vector<ElementVariable>& variables) const override {
    variables.push_back(variable("opening", Dimension::none));
    variables.push_back(variable("flow", Dimension::volume_flow));
  }
  double* read_variables(const CircuitView& view, double* values) const noexcept override {
    *values++ = view[u_];
    *values++ = -flow(view).value;
    return values;
  }
  void follow_oil(const PortOil& oil) noexcept override {
    fluidity_ = oil.fluidity(p_2_, p_1_);
    apply_parameters();
  }
  [[nodiscard]] void* def_address() noexcept override { return &def_; }
  void apply_parameters() noexcept override {
    plate_.set(def_.nominal_flow, def_.nominal_pressure_drop, def_.step_response);
    const double root_drop = def_.closing_flow / plate_.K();
    closing_drop_ = root_drop * root_drop;
    G_ = fluidity_ * def_.leak_flow / def_.leak_pressure;
  }

 private:
  [[nodiscard]] double drop(const CircuitView& view) const noexcept { return view[p_2_] - view[p_1_]; }
  // (2), with its slope over d
  [[nodiscard]] ValueSlope target(double d) const noexcept {
    const ValueSlope shut = unit_clip((d - closing_drop_) / def_.closing_pressure_rise, SpringSpool::kEndWidth);
    return {1 - shut.value, -shut.slope / def_.closing_pressure_rise};
  }
  // (3)
  [[nodiscard]] EdgeFlow flow(const CircuitView& view) const noexcept {
    EdgeFlow Q = plate_.edge(plate_.opening(view), drop(view));
    Q.value += G_ * drop(view);
    Q.over_drop += G_;
    return Q;
  }

  HoseBurstValveDef def_;
  StateIndex p_1_, p_2_;
  StateIndex u_;  // opening 0..1
  SpringSpool plate_;
  double fluidity_ = 1;  // of the oil, for leaks
  double closing_drop_ = 0, G_ = 0;
};

void validate_hose_burst_valve(const HydraulicsDef&, const ComponentDef& component, Problems& errors, Problems&) {
  const HoseBurstValveDef& def = static_cast<const HoseBurstValveDef&>(component);
  check_distinct(def.name + ".port_2", def.port_1, def.port_2, errors);
}

}  // namespace

void HoseBurstValveDef::add_lines(PumpLines& lines) const {
  const double drops = OilCompressibility::kHighest / nominal_pressure_drop;
  lines.open.push_back({.a = port_1, .b = port_2, .flow = nominal_flow * std::sqrt(drops), .is_one_way = true});
  lines.open_at_rest.emplace_back(port_1, port_2);
}

ComponentType hose_burst_valve_type() {
  return {.name = "hose_burst_valve",
          .fields = kHoseBurstValveFields,
          .doc = "valve that shuts when the flow out of a load exceeds its closing flow",
          .make_def = []() -> std::unique_ptr<ComponentDef> { return std::make_unique<HoseBurstValveDef>(); },
          .validate = validate_hose_burst_valve,
          .build = [](const ComponentDef& def, CircuitBuilder& builder) -> std::unique_ptr<HydraulicComponent> {
            return std::make_unique<HoseBurstValve>(static_cast<const HoseBurstValveDef&>(def), builder);
          }};
}

}  // namespace slew::hydraulics
