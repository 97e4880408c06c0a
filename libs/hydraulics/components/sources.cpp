// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/components/sources.h"

#include <cmath>
#include <limits>

#include "hydraulics/circuit_builder.h"
#include "hydraulics/component.h"
#include "hydraulics/components/shared_fields.h"
#include "hydraulics/passages.h"
#include "hydraulics/pump_lines.h"

namespace slew::hydraulics {
namespace {

constexpr Field kFlowSourceFields[] = {
    field<&FlowSourceDef::port_1>(
        "port_1", {.presence = Presence::required, .reference = "volume", .doc = "volume that gives the oil"}),
    field<&FlowSourceDef::port_2>(
        "port_2", {.presence = Presence::required, .reference = "volume", .doc = "volume that takes the oil"}),
    field<&FlowSourceDef::flow>("flow", {.dimension = Dimension::volume_flow,
                                         .range = kFinite,
                                         .change = Change::live,
                                         .doc = "flow without a control signal; negative: from port 2 to 1"}),
    field<&FlowSourceDef::flow_per_signal>("flow_per_signal", {.dimension = Dimension::volume_flow,
                                                               .range = kFinite,
                                                               .change = Change::live,
                                                               .doc = "flow per unit of the control signal"}),
};

constexpr Field kPressureSourceFields[] = {
    field<&PressureSourceDef::port_1>(
        "port_1", {.presence = Presence::required, .reference = "volume", .doc = "volume that the source feeds"}),
    field<&PressureSourceDef::set_pressure>("set_pressure", {.dimension = Dimension::pressure,
                                                             .range = kNotNegative,
                                                             .presence = Presence::required,
                                                             .change = Change::live,
                                                             .doc = "absolute pressure without a control signal"}),
    field<&PressureSourceDef::pressure_per_signal>("pressure_per_signal",
                                                   {.dimension = Dimension::pressure,
                                                    .range = kFinite,
                                                    .change = Change::live,
                                                    .doc = "pressure per unit of the control signal"}),
    field<&PressureSourceDef::nominal_flow>("nominal_flow", {.dimension = Dimension::volume_flow,
                                                             .range = kPositive,
                                                             .presence = Presence::required,
                                                             .change = Change::live,
                                                             .doc = "flow at nominal_pressure_drop"}),
    field<&PressureSourceDef::nominal_pressure_drop>(
        "nominal_pressure_drop",
        {.dimension = Dimension::pressure, .range = kPositive, .doc = "pressure drop of nominal_flow"}),
};

class FlowSource final : public HydraulicComponent {
 public:
  FlowSource(const FlowSourceDef& def, CircuitBuilder& builder)
      : HydraulicComponent(def),
        def_(def),
        p_1_(builder.volume(def.port_1)),
        p_2_(builder.volume(def.port_2)),
        control_(builder.add_control(def.name, SignalMoves::flows)) {
    builder.mark_supply(p_2_);
  }
  // the flow depends on no state
  void declare_dependencies(DependencyList&) const override {}
  void add_rates(const CircuitView& view, Rates& rates) const noexcept override { rates.move(p_1_, p_2_, flow(view)); }
  void add_jacobian(const CircuitView&, JacobianStamp&) const noexcept override {}
  void list_variables(std::vector<ElementVariable>& variables) const override {
    variables.push_back(variable("flow", Dimension::volume_flow));
    variables.push_back(variable("power", Dimension::power));
  }
  double* read_variables(const CircuitView& view, double* values) const noexcept override {
    *values++ = flow(view);
    *values++ = flow(view) * (view[p_2_] - view[p_1_]);
    return values;
  }
  [[nodiscard]] double shaft_power(const CircuitView& view) const noexcept override {
    return flow(view) * (view[p_2_] - view[p_1_]);
  }
  [[nodiscard]] void* def_address() noexcept override { return &def_; }
  void apply_parameters() noexcept override {}

 private:
  [[nodiscard]] double flow(const CircuitView& view) const noexcept {
    return def_.flow + def_.flow_per_signal * view.control[control_];
  }

  FlowSourceDef def_;
  StateIndex p_1_, p_2_;
  int control_;
};

class PressureSource final : public HydraulicComponent {
 public:
  PressureSource(const PressureSourceDef& def, CircuitBuilder& builder)
      : HydraulicComponent(def),
        def_(def),
        p_(builder.volume(def.port_1)),
        control_(builder.add_control(def.name, SignalMoves::flows)),
        supply_temperature_(builder.def().start_temperature) {
    apply_parameters();
  }
  void declare_dependencies(DependencyList& dependencies) const override { dependencies.add(p_, p_); }
  void add_rates(const CircuitView& view, Rates& rates) const noexcept override { rates.add_flow(p_, flow(view)); }
  void add_jacobian(const CircuitView&, JacobianStamp& jacobian) const noexcept override { jacobian.add(p_, p_, -G_); }
  void list_variables(std::vector<ElementVariable>& variables) const override {
    variables.push_back(variable("pressure", Dimension::pressure));
    variables.push_back(variable("flow", Dimension::volume_flow));
  }
  double* read_variables(const CircuitView& view, double* values) const noexcept override {
    *values++ = pressure(view);
    *values++ = flow(view);
    return values;
  }
  // fresh oil has the start temperature
  void add_passages(const CircuitView& view, Passages& passages) const noexcept override {
    const double Q = flow(view);
    if (Q > 0) passages.deliver(p_, Q, supply_temperature_, Q * (pressure(view) - view[p_]));
  }
  [[nodiscard]] void* def_address() noexcept override { return &def_; }
  void apply_parameters() noexcept override { G_ = def_.nominal_flow / def_.nominal_pressure_drop; }

 private:
  [[nodiscard]] double pressure(const CircuitView& view) const noexcept {
    return std::fmax(def_.set_pressure + def_.pressure_per_signal * view.control[control_], 0);
  }
  [[nodiscard]] double flow(const CircuitView& view) const noexcept { return G_ * (pressure(view) - view[p_]); }

  PressureSourceDef def_;
  StateIndex p_;
  int control_;
  double supply_temperature_;  // K
  double G_ = 0;
};

void validate_flow_source(const HydraulicsDef&, const ComponentDef& component, Problems& errors, Problems&) {
  const FlowSourceDef& def = static_cast<const FlowSourceDef&>(component);
  check_distinct(def.name + ".port_2", def.port_1, def.port_2, errors);
}

}  // namespace

void FlowSourceDef::add_lines(PumpLines& lines) const {
  lines.supply.insert(port_2);
  if (flow == 0 && flow_per_signal == 0) return;
  lines.pumps.push_back({.name = name,
                         .outlet = flow < 0 ? port_1 : port_2,
                         .inlet = flow < 0 ? port_2 : port_1,
                         .key = "flow",
                         .flow = std::fabs(flow),
                         .pressure = std::numeric_limits<double>::infinity()});
}

void PressureSourceDef::add_lines(PumpLines& lines) const {
  lines.held.insert(port_1);
}

ComponentType flow_source_type() {
  return {.name = "flow_source",
          .fields = kFlowSourceFields,
          .doc = "ideal source of flow, moved by a control signal",
          .make_def = []() -> std::unique_ptr<ComponentDef> { return std::make_unique<FlowSourceDef>(); },
          .validate = validate_flow_source,
          .build = [](const ComponentDef& def, CircuitBuilder& builder) -> std::unique_ptr<HydraulicComponent> {
            return std::make_unique<FlowSource>(static_cast<const FlowSourceDef&>(def), builder);
          },
          .has_control_signal = true};
}

ComponentType pressure_source_type() {
  return {.name = "pressure_source",
          .fields = kPressureSourceFields,
          .doc = "ideal source of pressure behind a laminar resistance, moved by a control signal",
          .make_def = []() -> std::unique_ptr<ComponentDef> { return std::make_unique<PressureSourceDef>(); },
          .validate = nullptr,
          .build = [](const ComponentDef& def, CircuitBuilder& builder) -> std::unique_ptr<HydraulicComponent> {
            return std::make_unique<PressureSource>(static_cast<const PressureSourceDef&>(def), builder);
          },
          .has_control_signal = true};
}

}  // namespace slew::hydraulics
