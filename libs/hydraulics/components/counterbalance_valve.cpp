// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/components/counterbalance_valve.h"

#include <cmath>

#include "hydraulics/circuit_builder.h"
#include "hydraulics/components/check_poppet.h"
#include "hydraulics/components/shared_fields.h"
#include "hydraulics/components/spring_spool.h"
#include "hydraulics/oil.h"
#include "hydraulics/pump_lines.h"

namespace slew::hydraulics {
namespace {

constexpr Field kCounterbalanceValveFields[] = {
    field<&CounterbalanceValveDef::port_1>("port_1", port_options("volume at the directional valve")),
    field<&CounterbalanceValveDef::port_2>("port_2", port_options("volume at the load")),
    field<&CounterbalanceValveDef::port_3>("port_3", port_options("volume that pilots the valve")),
    field<&CounterbalanceValveDef::port_4>(
        "port_4",
        {.reference = "volume", .doc = "volume of the spring's chamber of a vented valve, without it port_1"}),
    field<&CounterbalanceValveDef::setting_pressure>(
        "setting_pressure", {.dimension = Dimension::pressure,
                             .range = kPositive,
                             .presence = Presence::required,
                             .change = Change::live,
                             .doc = "pressure above the spring's chamber at which the load alone opens the valve"}),
    field<&CounterbalanceValveDef::pilot_ratio>(
        "pilot_ratio", {.range = kNotNegative, .doc = "area of the pilot over that of the relief; 0: no pilot"}),
    field<&CounterbalanceValveDef::nominal_flow>("nominal_flow",
                                                 nominal_flow_options("flow of the open valve from port 2 to 1 at "
                                                                      "nominal_pressure_drop")),
    field<&CounterbalanceValveDef::nominal_pressure_drop>("nominal_pressure_drop", kNominalPressureDrop),
    field<&CounterbalanceValveDef::opening_pressure_rise>("opening_pressure_rise",
                                                          {.dimension = Dimension::pressure,
                                                           .range = kPositive,
                                                           .doc = "rise above the setting that opens the valve fully"}),
    field<&CounterbalanceValveDef::step_response>("step_response",
                                                  step_response_options("three time constants of the opening")),
    field<&CounterbalanceValveDef::check, &CheckParameters::nominal_flow>(
        "check_flow", {.dimension = Dimension::volume_flow,
                       .range = kPositive,
                       .presence = Presence::required,
                       .change = Change::live,
                       .doc = "free flow from port 1 to 2 at check_pressure_drop"}),
    field<&CounterbalanceValveDef::check, &CheckParameters::nominal_pressure_drop>(
        "check_pressure_drop",
        {.dimension = Dimension::pressure, .range = kPositive, .doc = "pressure drop of check_flow"}),
    field<&CounterbalanceValveDef::check, &CheckParameters::crack_pressure>(
        "check_crack_pressure",
        {.dimension = Dimension::pressure, .range = kNotNegative, .doc = "pressure drop that lifts the check valve"}),
    field<&CounterbalanceValveDef::check, &CheckParameters::opening_pressure_rise>(
        "check_opening_pressure_rise",
        {.dimension = Dimension::pressure, .range = kPositive, .doc = "rise that opens the check valve fully"}),
};

class CounterbalanceValve final : public HydraulicComponent {
 public:
  CounterbalanceValve(const CounterbalanceValveDef& def, CircuitBuilder& builder)
      : HydraulicComponent(def),
        def_(def),
        p_1_(builder.volume(def.port_1)),
        p_2_(builder.volume(def.port_2)),
        pilot_(builder.volume(def.port_3)),
        spring_(builder.volume(def.port_4.empty() ? def.port_1 : def.port_4)),
        u_(builder.add_state({.initial = 0, .scale = 1})),
        spool_(u_, builder.def().orifice_transition),
        check_({.inlet = p_1_, .outlet = p_2_}, 0, builder.def().orifice_transition) {
    apply_parameters();
    builder.add_relief({.valve = def.name,
                        .volume = p_2_,
                        .outlet = spring_,
                        .fully_open = def.setting_pressure + def.opening_pressure_rise});
  }
  void start(double* y) const noexcept override { y[u_] = command(y).value; }
  void declare_dependencies(DependencyList& dependencies) const override {
    check_.declare_dependencies(dependencies);
    dependencies.add(p_1_, u_), dependencies.add(p_2_, u_), dependencies.add(u_, u_);
    dependencies.add(u_, p_2_), dependencies.add(u_, pilot_), dependencies.add(u_, spring_);
  }
  void add_rates(const CircuitView& view, Rates& rates) const noexcept override {
    spool_.add_rate(view, command(view.y).value, rates);
    rates.move(p_2_, p_1_, lowering_flow(view).value);
    check_.move(check_.flow(view), rates);
  }
  void add_jacobian(const CircuitView& view, JacobianStamp& jacobian) const noexcept override {
    const double d_command = spool_.rate() * command(view.y).slope / def_.opening_pressure_rise;
    jacobian.add(u_, u_, -spool_.rate());
    jacobian.add(u_, p_2_, d_command);
    jacobian.add(u_, pilot_, def_.pilot_ratio * d_command);
    jacobian.add(u_, spring_, -(1 + def_.pilot_ratio) * d_command);
    spool_.stamp_edge(p_2_, p_1_, lowering_flow(view), jacobian);
    check_.stamp(check_.flow(view), jacobian);
  }
  void raise_slopes(const CircuitView& view, JacobianStamp& slopes) const noexcept override {
    check_.raise_slopes(view, slopes);
  }
  void list_variables(std::vector<ElementVariable>& variables) const override {
    variables.push_back(variable("opening", Dimension::none));
    variables.push_back(variable("flow", Dimension::volume_flow));
  }
  double* read_variables(const CircuitView& view, double* values) const noexcept override {
    *values++ = view[u_];
    *values++ = check_.flow(view).value - lowering_flow(view).value;
    return values;
  }
  [[nodiscard]] void* def_address() noexcept override { return &def_; }
  void apply_parameters() noexcept override {
    spool_.set(def_.nominal_flow, def_.nominal_pressure_drop, def_.step_response);
    check_.set(def_.check, 0);
  }

 private:
  // clip of (2) with its slope over p_e / opening_pressure_rise, at the state y
  [[nodiscard]] ValueSlope command(const double* y) const noexcept {
    const double p_s = y[spring_];
    const double p_e = y[p_2_] - p_s + def_.pilot_ratio * (y[pilot_] - p_s) - def_.setting_pressure;
    return unit_clip(p_e / def_.opening_pressure_rise, SpringSpool::kEndWidth);
  }
  // (3)
  [[nodiscard]] EdgeFlow lowering_flow(const CircuitView& view) const noexcept {
    return spool_.edge(spool_.opening(view), view[p_2_] - view[p_1_]);
  }

  CounterbalanceValveDef def_;
  StateIndex p_1_, p_2_, pilot_, spring_;
  StateIndex u_;  // opening 0..1
  SpringSpool spool_;
  CheckPoppet check_;
};

void validate_counterbalance_valve(const HydraulicsDef&, const ComponentDef& component, Problems& errors, Problems&) {
  const CounterbalanceValveDef& def = static_cast<const CounterbalanceValveDef&>(component);
  check_nominal_drop(def.name + ".check_pressure_drop", def.check, errors);
  check_distinct(def.name + ".port_2", def.port_1, def.port_2, errors);
}

}  // namespace

void CounterbalanceValveDef::add_lines(PumpLines& lines) const {
  const double drops = OilCompressibility::kHighest / check.nominal_pressure_drop;
  lines.open.push_back({.a = port_1, .b = port_2, .flow = check.nominal_flow * std::sqrt(drops), .is_one_way = true});
  // opens at its setting without a pilot pressure
  if (!(setting_pressure < OilCompressibility::kHighest)) return;
  const double most = nominal_flow * std::sqrt(OilCompressibility::kHighest / nominal_pressure_drop);
  lines.open.push_back({.a = port_2, .b = port_1, .flow = most, .is_one_way = true});
}

ComponentType counterbalance_valve_type() {
  return {.name = "counterbalance_valve",
          .fields = kCounterbalanceValveFields,
          .doc = "counterbalance (over-centre) valve with a check valve",
          .make_def = []() -> std::unique_ptr<ComponentDef> { return std::make_unique<CounterbalanceValveDef>(); },
          .validate = validate_counterbalance_valve,
          .build = [](const ComponentDef& def, CircuitBuilder& builder) -> std::unique_ptr<HydraulicComponent> {
            return std::make_unique<CounterbalanceValve>(static_cast<const CounterbalanceValveDef&>(def), builder);
          }};
}

}  // namespace slew::hydraulics
