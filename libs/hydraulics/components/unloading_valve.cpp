// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/components/unloading_valve.h"

#include "hydraulics/circuit_builder.h"
#include "hydraulics/component.h"
#include "hydraulics/components/shared_fields.h"
#include "hydraulics/components/spring_spool.h"
#include "hydraulics/smooth.h"

namespace slew::hydraulics {
namespace {

constexpr Field kUnloadingValveFields[] = {
    field<&UnloadingValveDef::port_1>("port_1", port_options("volume at the pump")),
    field<&UnloadingValveDef::port_2>("port_2",
                                      port_options("volume of the tank, which the valve's pressures are relative to")),
    field<&UnloadingValveDef::port_3>("port_3", port_options("volume that is sensed, such as an accumulator's")),
    field<&UnloadingValveDef::cut_out_pressure>("cut_out_pressure",
                                                {.dimension = Dimension::pressure,
                                                 .range = kPositive,
                                                 .presence = Presence::required,
                                                 .change = Change::live,
                                                 .doc = "sensed pressure at which the valve opens to the tank"}),
    field<&UnloadingValveDef::cut_in_pressure>("cut_in_pressure", {.dimension = Dimension::pressure,
                                                                   .range = kPositive,
                                                                   .presence = Presence::required,
                                                                   .change = Change::live,
                                                                   .doc = "sensed pressure at which it shuts again"}),
    field<&UnloadingValveDef::opening_pressure_rise>(
        "opening_pressure_rise",
        {.dimension = Dimension::pressure, .range = kPositive, .doc = "rise from shut to open without hysteresis"}),
    field<&UnloadingValveDef::nominal_flow>("nominal_flow",
                                            nominal_flow_options("flow of the open valve at nominal_pressure_drop")),
    field<&UnloadingValveDef::nominal_pressure_drop>("nominal_pressure_drop", kNominalPressureDrop),
    field<&UnloadingValveDef::step_response>("step_response",
                                             step_response_options("three time constants of the opening")),
};

class UnloadingValve final : public HydraulicComponent {
 public:
  UnloadingValve(const UnloadingValveDef& def, CircuitBuilder& builder)
      : HydraulicComponent(def),
        def_(def),
        p_1_(builder.volume(def.port_1)),
        p_2_(builder.volume(def.port_2)),
        p_3_(builder.volume(def.port_3)),
        u_(builder.add_state({.initial = 0, .scale = 1})),
        spool_(u_, builder.def().orifice_transition) {
    apply_parameters();
  }
  // shut below the cut-out pressure, also above the cut-in one
  void start(double* y) const noexcept override { y[u_] = y[p_3_] - y[p_2_] > def_.cut_out_pressure ? 1 : 0; }
  void declare_dependencies(DependencyList& dependencies) const override {
    dependencies.add_restriction(p_1_, p_2_);
    for (const StateIndex row : {p_1_, p_2_, u_}) dependencies.add(row, u_);
    dependencies.add(u_, p_2_), dependencies.add(u_, p_3_);
  }
  void add_rates(const CircuitView& view, Rates& rates) const noexcept override {
    spool_.add_rate(view, command(view).value, rates);
    rates.move(p_1_, p_2_, flow(view).value);
  }
  void add_jacobian(const CircuitView& view, JacobianStamp& jacobian) const noexcept override {
    const double slope = command(view).slope;
    spool_.stamp_rate(p_3_, p_2_, slope, jacobian);
    jacobian.add(u_, u_, spool_.rate() * slope * hysteresis_);
    spool_.stamp_edge(p_1_, p_2_, flow(view), jacobian);
  }
  void list_variables(std::vector<ElementVariable>& variables) const override {
    variables.push_back(variable("opening", Dimension::none));
    variables.push_back(variable("flow", Dimension::volume_flow));
  }
  double* read_variables(const CircuitView& view, double* values) const noexcept override {
    *values++ = view[u_];
    *values++ = flow(view).value;
    return values;
  }
  [[nodiscard]] void* def_address() noexcept override { return &def_; }
  void apply_parameters() noexcept override {
    spool_.set(def_.nominal_flow, def_.nominal_pressure_drop, def_.step_response);
    hysteresis_ = def_.cut_out_pressure - def_.cut_in_pressure + def_.opening_pressure_rise;
  }

 private:
  // command of (1), with its slope over p_3
  [[nodiscard]] ValueSlope command(const CircuitView& view) const noexcept {
    const double open = def_.cut_out_pressure - hysteresis_ * view[u_];
    const ValueSlope u =
        unit_clip((view[p_3_] - view[p_2_] - open) / def_.opening_pressure_rise, SpringSpool::kEndWidth);
    return {u.value, u.slope / def_.opening_pressure_rise};
  }
  // (3)
  [[nodiscard]] EdgeFlow flow(const CircuitView& view) const noexcept {
    return spool_.edge(spool_.opening(view), view[p_1_] - view[p_2_]);
  }

  UnloadingValveDef def_;
  StateIndex p_1_, p_2_, p_3_;
  StateIndex u_;  // opening 0..1
  SpringSpool spool_;
  double hysteresis_ = 0;  // Pa, of p_open over u
};

void validate_unloading_valve(const HydraulicsDef&, const ComponentDef& component, Problems& errors, Problems&) {
  const UnloadingValveDef& def = static_cast<const UnloadingValveDef&>(component);
  check_distinct(def.name + ".port_2", def.port_1, def.port_2, errors);
  check_distinct(def.name + ".port_3", def.port_2, def.port_3, errors);
  if (def.cut_in_pressure > def.cut_out_pressure) {
    errors.push_back({def.name + ".cut_in_pressure", "the valve would shut above the pressure at which it opens",
                      "at most cut_out_pressure", ""});
  }
}

}  // namespace

ComponentType unloading_valve_type() {
  return {.name = "unloading_valve",
          .fields = kUnloadingValveFields,
          .doc = "valve that unloads a pump to the tank by a sensed pressure, with hysteresis",
          .make_def = []() -> std::unique_ptr<ComponentDef> { return std::make_unique<UnloadingValveDef>(); },
          .validate = validate_unloading_valve,
          .build = [](const ComponentDef& def, CircuitBuilder& builder) -> std::unique_ptr<HydraulicComponent> {
            return std::make_unique<UnloadingValve>(static_cast<const UnloadingValveDef&>(def), builder);
          }};
}

}  // namespace slew::hydraulics
