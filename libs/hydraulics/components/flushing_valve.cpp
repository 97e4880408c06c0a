// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/components/flushing_valve.h"

#include "hydraulics/circuit_builder.h"
#include "hydraulics/component.h"
#include "hydraulics/components/outlet_edges.h"
#include "hydraulics/components/shared_fields.h"
#include "hydraulics/smooth.h"

namespace slew::hydraulics {
namespace {

constexpr Field kFlushingValveFields[] = {
    field<&FlushingValveDef::port_1>("port_1", port_options("volume of one side of the closed circuit")),
    field<&FlushingValveDef::port_2>("port_2", port_options("volume of the other side")),
    field<&FlushingValveDef::port_3>("port_3", port_options("volume that takes the oil of the lower side")),
    field<&FlushingValveDef::nominal_flow>("nominal_flow",
                                           nominal_flow_options("flow of the open valve at nominal_pressure_drop")),
    field<&FlushingValveDef::nominal_pressure_drop>("nominal_pressure_drop", kNominalPressureDrop),
    field<&FlushingValveDef::switching_pressure>("switching_pressure",
                                                 {.dimension = Dimension::pressure,
                                                  .range = kNotNegative,
                                                  .change = Change::live,
                                                  .doc = "difference of the sides from which on an edge opens"}),
    field<&FlushingValveDef::opening_pressure_rise>(
        "opening_pressure_rise",
        {.dimension = Dimension::pressure, .range = kPositive, .doc = "rise from shut to fully open"}),
};

constexpr double kFlushingEndWidth = 0.02;  // share of the spool's travel, smoothing of its ends

class FlushingValve final : public HydraulicComponent {
 public:
  FlushingValve(const FlushingValveDef& def, CircuitBuilder& builder)
      : HydraulicComponent(def), def_(def), edges_(def, builder) {
    apply_parameters();
  }
  void declare_dependencies(DependencyList& dependencies) const override { edges_.declare_dependencies(dependencies); }
  void add_rates(const CircuitView& view, Rates& rates) const noexcept override {
    for (const int i : {0, 1}) edges_.move(i, flow(view, i).value, rates);
  }
  void add_jacobian(const CircuitView& view, JacobianStamp& jacobian) const noexcept override {
    for (const int i : {0, 1}) {
      const EdgeFlow Q = flow(view, i);
      edges_.stamp(i, i, Q.over_drop - Q.over_position, jacobian);
      edges_.stamp_outlet(i, -Q.over_drop, jacobian);
      edges_.stamp(i, 1 - i, Q.over_position, jacobian);
    }
  }
  void list_variables(std::vector<ElementVariable>& variables) const override {
    variables.push_back(variable("opening_1", Dimension::none));
    variables.push_back(variable("opening_2", Dimension::none));
    variables.push_back(variable("flow_1", Dimension::volume_flow));
    variables.push_back(variable("flow_2", Dimension::volume_flow));
  }
  double* read_variables(const CircuitView& view, double* values) const noexcept override {
    for (const int i : {0, 1}) *values++ = opening(view, i).value;
    for (const int i : {0, 1}) *values++ = flow(view, i).value;
    return values;
  }
  [[nodiscard]] void* def_address() noexcept override { return &def_; }
  void apply_parameters() noexcept override { edges_.set(def_.nominal_flow, def_.nominal_pressure_drop); }

 private:
  // (1) of side i with its slope over the other side's pressure
  [[nodiscard]] ValueSlope opening(const CircuitView& view, int i) const noexcept {
    const double rise = def_.opening_pressure_rise;
    const double above = view[edges_.inlet(1 - i)] - view[edges_.inlet(i)] - def_.switching_pressure;
    const ValueSlope u = unit_clip(above / rise, kFlushingEndWidth);
    return {u.value, u.slope / rise};
  }
  // (2)
  [[nodiscard]] EdgeFlow flow(const CircuitView& view, int i) const noexcept {
    return edges_.flow(view, i, opening(view, i));
  }

  FlushingValveDef def_;
  OutletEdges edges_;
};

void validate_flushing_valve(const HydraulicsDef&, const ComponentDef& component, Problems& errors, Problems&) {
  const FlushingValveDef& def = static_cast<const FlushingValveDef&>(component);
  check_three_ports(def, errors);
}

}  // namespace

ComponentType flushing_valve_type() {
  return {.name = "flushing_valve",
          .fields = kFlushingValveFields,
          .doc = "flushing valve of a closed circuit: the outlet takes oil of the side of the lower pressure",
          .make_def = []() -> std::unique_ptr<ComponentDef> { return std::make_unique<FlushingValveDef>(); },
          .validate = validate_flushing_valve,
          .build = [](const ComponentDef& def, CircuitBuilder& builder) -> std::unique_ptr<HydraulicComponent> {
            return std::make_unique<FlushingValve>(static_cast<const FlushingValveDef&>(def), builder);
          }};
}

}  // namespace slew::hydraulics
