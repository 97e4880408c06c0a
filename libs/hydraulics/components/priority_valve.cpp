// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/components/priority_valve.h"

#include "hydraulics/circuit_builder.h"
#include "hydraulics/component.h"
#include "hydraulics/components/shared_fields.h"
#include "hydraulics/components/spring_spool.h"
#include "hydraulics/pump_lines.h"
#include "hydraulics/smooth.h"

namespace slew::hydraulics {
namespace {

constexpr Field kPriorityValveFields[] = {
    field<&PriorityValveDef::port_1>("port_1", port_options("volume at the pump")),
    field<&PriorityValveDef::port_2>("port_2", port_options("volume of the priority line")),
    field<&PriorityValveDef::port_3>("port_3", port_options("volume of the other line")),
    field<&PriorityValveDef::port_t>("port_t",
                                     port_options("volume of the tank, which the valve's pressures are relative to")),
    field<&PriorityValveDef::ls_port>(
        "ls_port", {.reference = "component", .doc = "component with the load-sensing pressure of the priority line"}),
    field<&PriorityValveDef::spring_pressure>(
        "spring_pressure", {.dimension = Dimension::pressure,
                            .range = kPositive,
                            .change = Change::live,
                            .doc = "pressure above the load-sensing one that begins to open the other line"}),
    field<&PriorityValveDef::regulation_pressure>(
        "regulation_pressure", {.dimension = Dimension::pressure,
                                .range = kPositive,
                                .doc = "rise that moves all oil from the priority line to the other"}),
    field<&PriorityValveDef::nominal_flow>("nominal_flow",
                                           nominal_flow_options("flow of either open edge at nominal_pressure_drop")),
    field<&PriorityValveDef::nominal_pressure_drop>("nominal_pressure_drop", kNominalPressureDrop),
    field<&PriorityValveDef::step_response>("step_response",
                                            step_response_options("three time constants of the opening")),
};

class PriorityValve final : public HydraulicComponent {
 public:
  PriorityValve(const PriorityValveDef& def, CircuitBuilder& builder)
      : HydraulicComponent(def),
        def_(def),
        p_1_(builder.volume(def.port_1)),
        p_2_(builder.volume(def.port_2)),
        p_3_(builder.volume(def.port_3)),
        t_(builder.volume(def.port_t)),
        ls_(def.ls_port.empty() ? -1 : builder.ls_index(def.ls_port)),
        u_(builder.add_state({.initial = 0, .scale = 1})),
        spool_(u_, builder.def().orifice_transition) {
    apply_parameters();
  }
  void declare_dependencies(DependencyList& dependencies) const override {
    dependencies.add_restriction(p_1_, p_2_), dependencies.add_restriction(p_1_, p_3_);
    for (const StateIndex row : {p_1_, p_2_, p_3_, u_}) dependencies.add(row, u_);
    dependencies.add(u_, p_2_), dependencies.add(u_, t_);
    if (ls_ >= 0) dependencies.add_ls(u_, ls_);
  }
  void add_rates(const CircuitView& view, Rates& rates) const noexcept override {
    spool_.add_rate(view, command(view).value, rates);
    rates.move(p_1_, p_2_, flow(view, p_2_).value);
    rates.move(p_1_, p_3_, flow(view, p_3_).value);
  }
  void add_jacobian(const CircuitView& view, JacobianStamp& jacobian) const noexcept override {
    const double slope = command(view).slope;
    spool_.stamp_rate(p_2_, t_, slope, jacobian);
    if (ls_ >= 0) jacobian.add_ls(u_, ls_, -(spool_.rate() * slope));
    for (const StateIndex outlet : {p_2_, p_3_}) spool_.stamp_edge(p_1_, outlet, flow(view, outlet), jacobian);
  }
  void list_variables(std::vector<ElementVariable>& variables) const override {
    variables.push_back(variable("spool_position", Dimension::none));
    variables.push_back(variable("priority_flow", Dimension::volume_flow));
    variables.push_back(variable("flow", Dimension::volume_flow));
  }
  double* read_variables(const CircuitView& view, double* values) const noexcept override {
    *values++ = view[u_];
    *values++ = flow(view, p_2_).value;
    *values++ = flow(view, p_3_).value;
    return values;
  }
  [[nodiscard]] void* def_address() noexcept override { return &def_; }
  void apply_parameters() noexcept override {
    spool_.set(def_.nominal_flow, def_.nominal_pressure_drop, def_.step_response);
  }

 private:
  // command of (1), with its slope over p_2
  [[nodiscard]] ValueSlope command(const CircuitView& view) const noexcept {
    const double demand = def_.spring_pressure + (ls_ < 0 ? 0 : view.ls[ls_]);
    const ValueSlope u = unit_clip((view[p_2_] - view[t_] - demand) / def_.regulation_pressure, SpringSpool::kEndWidth);
    return {u.value, u.slope / def_.regulation_pressure};
  }
  // (2), (3)
  [[nodiscard]] EdgeFlow flow(const CircuitView& view, StateIndex outlet) const noexcept {
    const double side = outlet == p_2_ ? -1 : 1, u = side < 0 ? 1 - view[u_] : view[u_];
    if (u <= 0) return {};
    return spool_.edge({u, side}, view[p_1_] - view[outlet]);
  }

  PriorityValveDef def_;
  StateIndex p_1_, p_2_, p_3_, t_;
  LsIndex ls_;    // -1: none
  StateIndex u_;  // 0: priority line alone, 1: other line alone
  SpringSpool spool_;
};

void validate_priority_valve(const HydraulicsDef&, const ComponentDef& component, Problems& errors, Problems&) {
  const PriorityValveDef& def = static_cast<const PriorityValveDef&>(component);
  check_three_ports(def, errors);
}

}  // namespace

// Blocked in the priority line, it passes the pump's flow into the other one.
void PriorityValveDef::add_lines(PumpLines& lines) const {
  lines.open.push_back({.a = port_1, .b = port_3, .is_one_way = true});
}

ComponentType priority_valve_type() {
  return {.name = "priority_valve",
          .fields = kPriorityValveFields,
          .doc = "valve that gives the pump's flow to a priority line first",
          .make_def = []() -> std::unique_ptr<ComponentDef> { return std::make_unique<PriorityValveDef>(); },
          .validate = validate_priority_valve,
          .build = [](const ComponentDef& def, CircuitBuilder& builder) -> std::unique_ptr<HydraulicComponent> {
            return std::make_unique<PriorityValve>(static_cast<const PriorityValveDef&>(def), builder);
          }};
}

}  // namespace slew::hydraulics
