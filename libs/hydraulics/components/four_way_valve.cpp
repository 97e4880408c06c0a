// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/components/four_way_valve.h"

#include <algorithm>
#include <cmath>

#include "hydraulics/circuit_builder.h"
#include "hydraulics/component.h"
#include "hydraulics/oil_properties.h"
#include "hydraulics/passages.h"
#include "hydraulics/pump_lines.h"
#include "hydraulics/smooth.h"

namespace slew::hydraulics {
namespace {

constexpr Field kFourWayValveFields[] = {
    field<&FourWayValveDef::port_p>(
        "port_p", {.presence = Presence::required, .reference = "volume", .doc = "volume at the supply"}),
    field<&FourWayValveDef::port_a>("port_a",
                                    {.presence = Presence::required, .reference = "volume", .doc = "volume at port A"}),
    field<&FourWayValveDef::port_b>("port_b",
                                    {.presence = Presence::required, .reference = "volume", .doc = "volume at port B"}),
    field<&FourWayValveDef::port_t>(
        "port_t", {.presence = Presence::required, .reference = "volume", .doc = "volume at the return"}),
    field<&FourWayValveDef::edge_area>("edge_area", {.dimension = Dimension::area,
                                                     .range = kPositive,
                                                     .presence = Presence::required,
                                                     .change = Change::live,
                                                     .doc = "area of one metering edge, fully open"}),
    field<&FourWayValveDef::discharge_coefficient>("discharge_coefficient",
                                                   {.range = kFractionAboveZero, .doc = "discharge coefficient"}),
    field<&FourWayValveDef::neutral_opening>(
        "neutral_opening",
        {.range = kFraction, .change = Change::live, .doc = "opening of P-A and B-T without a signal"}),
    field<&FourWayValveDef::opening_gain>(
        "opening_gain", {.range = kFinite, .change = Change::live, .doc = "opening per unit of the control signal"}),
};

class FourWayValve final : public HydraulicComponent {
 public:
  FourWayValve(const FourWayValveDef& def, CircuitBuilder& builder)
      : HydraulicComponent(def),
        def_(def),
        p_(builder.volume(def.port_p)),
        a_(builder.volume(def.port_a)),
        b_(builder.volume(def.port_b)),
        t_(builder.volume(def.port_t)),
        control_(builder.add_control(def.name, SignalMoves::flows)),
        transition_(builder.def().orifice_transition),
        root_2_rho_(std::sqrt(2 / builder.def().oil_density)) {
    apply_parameters();
  }
  void declare_dependencies(DependencyList& dependencies) const override {
    for (const StateIndex port : {a_, b_}) {
      dependencies.add_restriction(p_, port);
      dependencies.add_restriction(port, t_);
    }
  }
  void add_rates(const CircuitView& view, Rates& rates) const noexcept override {
    const double forward = conductance_ * opening(view), back = conductance_ - forward;
    rates.move(p_, a_, flow(view, p_, a_, forward).value);
    rates.move(b_, t_, flow(view, b_, t_, forward).value);
    rates.move(p_, b_, flow(view, p_, b_, back).value);
    rates.move(a_, t_, flow(view, a_, t_, back).value);
  }
  void add_jacobian(const CircuitView& view, JacobianStamp& jacobian) const noexcept override {
    const double forward = conductance_ * opening(view), back = conductance_ - forward;
    stamp(view, jacobian, p_, a_, forward);
    stamp(view, jacobian, b_, t_, forward);
    stamp(view, jacobian, p_, b_, back);
    stamp(view, jacobian, a_, t_, back);
  }
  void list_variables(std::vector<ElementVariable>& variables) const override {
    variables.push_back(variable("opening", Dimension::none));
    for (const char* flow : {"flow_pa", "flow_bt", "flow_pb", "flow_at"}) {
      variables.push_back(variable(flow, Dimension::volume_flow));
    }
  }
  double* read_variables(const CircuitView& view, double* values) const noexcept override {
    const double u = opening(view), forward = conductance_ * u, back = conductance_ - forward;
    *values++ = u;
    *values++ = flow(view, p_, a_, forward).value;
    *values++ = flow(view, b_, t_, forward).value;
    *values++ = flow(view, p_, b_, back).value;
    *values++ = flow(view, a_, t_, back).value;
    return values;
  }
  [[nodiscard]] void* def_address() noexcept override { return &def_; }
  void add_passages(const CircuitView& view, Passages& passages) const noexcept override {
    const double forward = conductance_ * opening(view), back = conductance_ - forward;
    passages.move(p_, a_, flow(view, p_, a_, forward).value);
    passages.move(b_, t_, flow(view, b_, t_, forward).value);
    passages.move(p_, b_, flow(view, p_, b_, back).value);
    passages.move(a_, t_, flow(view, a_, t_, back).value);
  }
  void follow_oil(const PortOil& oil) noexcept override {
    root_2_rho_ = std::sqrt(2 / oil.between(p_, t_).density);
    apply_parameters();
  }
  void apply_parameters() noexcept override {
    conductance_ = def_.discharge_coefficient * def_.edge_area * root_2_rho_;
  }

 private:
  [[nodiscard]] double opening(const CircuitView& view) const noexcept {
    return std::clamp(def_.neutral_opening + def_.opening_gain * view.control[control_], 0.0, 1.0);
  }
  [[nodiscard]] ValueSlope flow(const CircuitView& view, StateIndex from, StateIndex to, double K) const noexcept {
    const ValueSlope r = root(view[from] - view[to], transition_);
    return {K * r.value, K * r.slope};
  }
  void stamp(const CircuitView& view, JacobianStamp& jacobian, StateIndex from, StateIndex to,
             double K) const noexcept {
    const double slope = flow(view, from, to, K).slope;
    jacobian.move(from, to, from, slope);
    jacobian.move(from, to, to, -slope);
  }

  FourWayValveDef def_;
  StateIndex p_, a_, b_, t_;
  int control_;
  double transition_, root_2_rho_;
  double conductance_ = 0;  // m3/s/sqrt(Pa), one edge fully open
};

}  // namespace

void FourWayValveDef::add_lines(PumpLines& lines) const {
  if (opening_gain != 0) return;
  if (neutral_opening > 0) lines.open.insert(lines.open.end(), {{port_p, port_a}, {port_b, port_t}});
  if (neutral_opening < 1) lines.open.insert(lines.open.end(), {{port_p, port_b}, {port_a, port_t}});
}

ComponentType four_way_valve_type() {
  return {.name = "four_way_valve",
          .fields = kFourWayValveFields,
          .doc = "four-way valve with complementary metering edges",
          .make_def = []() -> std::unique_ptr<ComponentDef> { return std::make_unique<FourWayValveDef>(); },
          .validate = nullptr,
          .build = [](const ComponentDef& def, CircuitBuilder& builder) -> std::unique_ptr<HydraulicComponent> {
            return std::make_unique<FourWayValve>(static_cast<const FourWayValveDef&>(def), builder);
          },
          .has_control_signal = true};
}

}  // namespace slew::hydraulics
