// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/components/shuttle_valve.h"

#include "hydraulics/circuit_builder.h"
#include "hydraulics/component.h"
#include "hydraulics/components/outlet_edges.h"
#include "hydraulics/components/shared_fields.h"
#include "hydraulics/smooth.h"

namespace slew::hydraulics {
namespace {

constexpr Field kShuttleValveFields[] = {
    field<&ShuttleValveDef::port_1>("port_1", port_options("volume at one inlet")),
    field<&ShuttleValveDef::port_2>("port_2", port_options("volume at the other inlet")),
    field<&ShuttleValveDef::port_3>("port_3", port_options("volume at the outlet")),
    field<&ShuttleValveDef::nominal_flow>("nominal_flow",
                                          nominal_flow_options("flow of the open seat at nominal_pressure_drop")),
    field<&ShuttleValveDef::nominal_pressure_drop>("nominal_pressure_drop", kNominalPressureDrop),
    field<&ShuttleValveDef::switching_pressure>("switching_pressure",
                                                {.dimension = Dimension::pressure,
                                                 .range = kPositive,
                                                 .doc = "difference of the inlets that holds the ball on a seat"}),
};

constexpr double kBallEndWidth = 0.02;  // share of the ball's travel, smoothing of its ends

class ShuttleValve final : public HydraulicComponent {
 public:
  ShuttleValve(const ShuttleValveDef& def, CircuitBuilder& builder)
      : HydraulicComponent(def), def_(def), edges_(def, builder) {
    apply_parameters();
  }
  void declare_dependencies(DependencyList& dependencies) const override { edges_.declare_dependencies(dependencies); }
  void add_rates(const CircuitView& view, Rates& rates) const noexcept override {
    for (const int i : {0, 1}) edges_.move(i, flow(view, i), rates);
  }
  void add_jacobian(const CircuitView& view, JacobianStamp& jacobian) const noexcept override {
    for (const int i : {0, 1}) {
      const EdgeFlow Q = flow(view, i);
      edges_.stamp(i, i, Q.over_drop, jacobian);
      edges_.stamp_outlet(i, -Q.over_drop, jacobian);
      edges_.stamp(i, 0, Q.over_position, jacobian);
      edges_.stamp(i, 1, -Q.over_position, jacobian);
    }
  }
  void list_variables(std::vector<ElementVariable>& variables) const override {
    variables.push_back(variable("position", Dimension::none));
    variables.push_back(variable("flow_1", Dimension::volume_flow));
    variables.push_back(variable("flow_2", Dimension::volume_flow));
  }
  double* read_variables(const CircuitView& view, double* values) const noexcept override {
    *values++ = position(view).value;
    for (const int i : {0, 1}) *values++ = flow(view, i).value;
    return values;
  }
  [[nodiscard]] void* def_address() noexcept override { return &def_; }
  void apply_parameters() noexcept override { edges_.set(def_.nominal_flow, def_.nominal_pressure_drop); }

 private:
  // (1) with its slope over p_1 - p_2
  [[nodiscard]] ValueSlope position(const CircuitView& view) const noexcept {
    const double x = (view[edges_.inlet(0)] - view[edges_.inlet(1)]) / def_.switching_pressure;
    const ValueSlope a = unit_clip(0.5 * (1 + x), kBallEndWidth);
    return {a.value, 0.5 * a.slope / def_.switching_pressure};
  }
  // (2)
  [[nodiscard]] EdgeFlow flow(const CircuitView& view, int i) const noexcept {
    const ValueSlope a = position(view);
    return edges_.flow(view, i, i == 0 ? a : ValueSlope{1 - a.value, -a.slope});
  }

  ShuttleValveDef def_;
  OutletEdges edges_;
};

void validate_shuttle_valve(const HydraulicsDef&, const ComponentDef& component, Problems& errors, Problems&) {
  const ShuttleValveDef& def = static_cast<const ShuttleValveDef&>(component);
  check_three_ports(def, errors);
}

}  // namespace

ComponentType shuttle_valve_type() {
  return {.name = "shuttle_valve",
          .fields = kShuttleValveFields,
          .doc = "shuttle valve: the outlet takes the inlet of the higher pressure",
          .make_def = []() -> std::unique_ptr<ComponentDef> { return std::make_unique<ShuttleValveDef>(); },
          .validate = validate_shuttle_valve,
          .build = [](const ComponentDef& def, CircuitBuilder& builder) -> std::unique_ptr<HydraulicComponent> {
            return std::make_unique<ShuttleValve>(static_cast<const ShuttleValveDef&>(def), builder);
          }};
}

}  // namespace slew::hydraulics
