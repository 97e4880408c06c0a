// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/components/shuttle_valve.h"

#include <algorithm>
#include <cmath>

#include "hydraulics/circuit_builder.h"
#include "hydraulics/component.h"
#include "hydraulics/components/outlet_edges.h"
#include "hydraulics/components/shared_fields.h"
#include "hydraulics/oil.h"
#include "hydraulics/pump_lines.h"
#include "hydraulics/smooth.h"

namespace slew::hydraulics {
namespace {

constexpr Field kShuttleValveFields[] = {
    field<&ShuttleValveDef::port_1>("port_1", port_options("volume at one inlet")),
    field<&ShuttleValveDef::port_2>("port_2", port_options("volume at the other inlet")),
    field<&ShuttleValveDef::port_3>("port_3", port_options("volume at the outlet")),
    field<&ShuttleValveDef::nominal_flow>("nominal_flow",
                                          nominal_flow_options("flow of the open valve at nominal_pressure_drop")),
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
    for (const int i : {0, 1}) edges_.move(i, flow(view, i).value, rates);
  }
  void add_jacobian(const CircuitView& view, JacobianStamp& jacobian) const noexcept override {
    for (const int i : {0, 1}) {
      const SeatFlow Q = flow(view, i);
      edges_.stamp(i, i, Q.over_inlet, jacobian);
      edges_.stamp(i, 1 - i, Q.over_other, jacobian);
      edges_.stamp_outlet(i, -Q.over_inlet - Q.over_other, jacobian);
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
  struct SeatFlow {
    double value, over_inlet, over_other, over_position;  // m3/s, m3/s/Pa; the position's over p_1 - p_2
  };
  // (2)
  [[nodiscard]] SeatFlow flow(const CircuitView& view, int i) const noexcept {
    const ValueSlope a = position(view);
    const double KA = (i == 0 ? a.value : 1 - a.value) * edges_.K();
    const double p_3 = view[edges_.outlet()], drop = view[edges_.inlet(i)] - p_3;
    const ValueSlope in = driven(drop), back = driven(-drop);
    const ValueSlope share = rise(p_3 - view[edges_.inlet(1 - i)]);
    const double drive = in.value - share.value * back.value;
    return {KA * drive, KA * (in.slope + share.value * back.slope), KA * share.slope * back.value,
            (i == 0 ? a.slope : -a.slope) * edges_.K() * drive};
  }
  // (4)
  [[nodiscard]] ValueSlope rise(double drop) const noexcept {
    const double t = std::clamp(drop / edges_.transition(), 0.0, 1.0);
    return {t * t * t * (10 + t * (6 * t - 15)), 30 * t * t * (1 - t) * (1 - t) / edges_.transition()};
  }
  // (3)
  [[nodiscard]] ValueSlope driven(double drop) const noexcept {
    if (drop <= 0) return {0, 0};
    const ValueSlope r = root(drop, edges_.transition()), s = rise(drop);
    return {s.value * r.value, s.slope * r.value + s.value * r.slope};
  }

  ShuttleValveDef def_;
  OutletEdges edges_;
};

void validate_shuttle_valve(const HydraulicsDef&, const ComponentDef& component, Problems& errors, Problems&) {
  const ShuttleValveDef& def = static_cast<const ShuttleValveDef&>(component);
  check_three_ports(def, errors);
}

}  // namespace

// whichever inlet has the higher pressure
void ShuttleValveDef::add_lines(PumpLines& lines) const {
  const double most = nominal_flow * std::sqrt(OilCompressibility::kHighest / nominal_pressure_drop);
  for (const std::string* inlet : {&port_1, &port_2}) {
    lines.open.push_back({.a = *inlet, .b = port_3, .flow = most, .is_one_way = true});
  }
}

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
