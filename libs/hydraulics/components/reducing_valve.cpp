// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/components/reducing_valve.h"

#include <cmath>

#include "hydraulics/circuit_builder.h"
#include "hydraulics/component.h"
#include "hydraulics/components/shared_fields.h"
#include "hydraulics/components/spring_spool.h"
#include "hydraulics/smooth.h"

namespace slew::hydraulics {
namespace {

constexpr Field kReducingValveFields[] = {
    field<&ReducingValveDef::port_1>("port_1", port_options("volume at the supply")),
    field<&ReducingValveDef::port_2>("port_2", port_options("volume whose pressure is reduced")),
    field<&ReducingValveDef::port_3>("port_3", port_options("volume at the drain, which the setting is relative to")),
    field<&ReducingValveDef::setting_pressure>("setting_pressure",
                                               {.dimension = Dimension::pressure,
                                                .range = kNotNegative,
                                                .change = Change::live,
                                                .doc = "reduced pressure above the drain without a control signal"}),
    field<&ReducingValveDef::pressure_per_signal>("pressure_per_signal",
                                                  {.dimension = Dimension::pressure,
                                                   .change = Change::live,
                                                   .doc = "reduced pressure per unit of the control signal"}),
    field<&ReducingValveDef::regulation_pressure>(
        "regulation_pressure",
        {.dimension = Dimension::pressure, .range = kPositive, .doc = "deviation that opens the valve fully"}),
    field<&ReducingValveDef::nominal_flow>("nominal_flow",
                                           nominal_flow_options("flow of the open valve at nominal_pressure_drop")),
    field<&ReducingValveDef::nominal_pressure_drop>("nominal_pressure_drop", kNominalPressureDrop),
    field<&ReducingValveDef::step_response>("step_response",
                                            step_response_options("three time constants of the opening")),
};

// w_u of (4), share of the travel: both edges pass 2.5e-4 of their full flow in the middle, as the lands of pilot
// valves leak: 4 ml/min of 10 l/min between 60, 25 and 1 bar. Without it the middle is a rest where the outlet is held.
constexpr double kUnderlap = 1e-3;

class ReducingValve final : public HydraulicComponent {
 public:
  ReducingValve(const ReducingValveDef& def, CircuitBuilder& builder)
      : HydraulicComponent(def),
        def_(def),
        p_1_(builder.volume(def.port_1)),
        p_2_(builder.volume(def.port_2)),
        p_3_(builder.volume(def.port_3)),
        y_(builder.add_state({.initial = 0, .scale = 1})),
        control_(builder.add_control(def.name, SignalMoves::a_state)),
        spool_(y_, builder.def().orifice_transition) {
    apply_parameters();
  }
  // at the position that the start pressures command
  void start(double* y) const noexcept override { y[y_] = command(set_pressure(0), y[p_2_] - y[p_3_]).value; }
  void declare_dependencies(DependencyList& dependencies) const override {
    dependencies.add_restriction(p_1_, p_2_), dependencies.add_restriction(p_2_, p_3_);
    for (const StateIndex row : {p_1_, p_2_, p_3_, y_}) dependencies.add(row, y_);
    dependencies.add(y_, p_2_), dependencies.add(y_, p_3_);
  }
  void add_rates(const CircuitView& view, Rates& rates) const noexcept override {
    spool_.add_rate(view, command(view).value, rates);
    rates.move(p_1_, p_2_, flow(view, p_1_, p_2_, 1).value);
    rates.move(p_2_, p_3_, flow(view, p_2_, p_3_, -1).value);
  }
  void add_jacobian(const CircuitView& view, JacobianStamp& jacobian) const noexcept override {
    spool_.stamp_rate(p_2_, p_3_, command(view).slope, jacobian);
    spool_.stamp_edge(p_1_, p_2_, flow(view, p_1_, p_2_, 1), jacobian);
    spool_.stamp_edge(p_2_, p_3_, flow(view, p_2_, p_3_, -1), jacobian);
  }
  void list_variables(std::vector<ElementVariable>& variables) const override {
    variables.push_back(variable("set_pressure", Dimension::pressure));
    variables.push_back(variable("spool_position", Dimension::none));
    variables.push_back(variable("flow", Dimension::volume_flow));
    variables.push_back(variable("drain_flow", Dimension::volume_flow));
  }
  double* read_variables(const CircuitView& view, double* values) const noexcept override {
    *values++ = set_pressure(view.control[control_]);
    *values++ = view[y_];
    *values++ = flow(view, p_1_, p_2_, 1).value;
    *values++ = flow(view, p_2_, p_3_, -1).value;
    return values;
  }
  [[nodiscard]] void* def_address() noexcept override { return &def_; }
  void apply_parameters() noexcept override {
    spool_.set(def_.nominal_flow, def_.nominal_pressure_drop, def_.step_response);
  }

 private:
  // (2)
  [[nodiscard]] double set_pressure(double signal) const noexcept {
    return std::fmax(def_.setting_pressure + def_.pressure_per_signal * signal, 0);
  }
  // command of (1) at the outlet's pressure above the drain, with its slope over that
  [[nodiscard]] ValueSlope command(double set, double outlet) const noexcept {
    const double x = (set - outlet) / def_.regulation_pressure;
    const ValueSlope twice = unit_clip(0.5 * (x + 1), 0.5 * SpringSpool::kEndWidth);
    return {2 * twice.value - 1, -twice.slope / def_.regulation_pressure};
  }
  [[nodiscard]] ValueSlope command(const CircuitView& view) const noexcept {
    return command(set_pressure(view.control[control_]), view[p_2_] - view[p_3_]);
  }
  // (3), (4); side: 1 supply, -1 drain
  [[nodiscard]] EdgeFlow flow(const CircuitView& view, StateIndex from, StateIndex to, double side) const noexcept {
    const ValueSlope u = underlap(side * view[y_], kUnderlap);
    return spool_.edge({u.value, side * u.slope}, view[from] - view[to]);
  }

  ReducingValveDef def_;
  StateIndex p_1_, p_2_, p_3_;
  StateIndex y_;  // -1..1
  int control_;
  SpringSpool spool_;
};

void validate_reducing_valve(const HydraulicsDef&, const ComponentDef& component, Problems& errors, Problems&) {
  const ReducingValveDef& def = static_cast<const ReducingValveDef&>(component);
  check_distinct(def.name + ".port_2", def.port_1, def.port_2, errors);
  check_distinct(def.name + ".port_3", def.port_2, def.port_3, errors);
}

}  // namespace

ComponentType reducing_valve_type() {
  return {.name = "reducing_valve",
          .fields = kReducingValveFields,
          .doc = "pressure-reducing and relieving valve of three ways, at a setting or by a control signal",
          .make_def = []() -> std::unique_ptr<ComponentDef> { return std::make_unique<ReducingValveDef>(); },
          .validate = validate_reducing_valve,
          .build = [](const ComponentDef& def, CircuitBuilder& builder) -> std::unique_ptr<HydraulicComponent> {
            return std::make_unique<ReducingValve>(static_cast<const ReducingValveDef&>(def), builder);
          },
          .has_control_signal = true};
}

}  // namespace slew::hydraulics
