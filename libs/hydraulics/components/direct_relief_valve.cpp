// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/components/direct_relief_valve.h"

#include <cmath>
#include <numbers>
#include "hydraulics/circuit_builder.h"
#include "hydraulics/component.h"
#include "hydraulics/oil.h"
#include "hydraulics/oil_properties.h"
#include "hydraulics/pump_lines.h"
#include "hydraulics/smooth.h"

namespace slew::hydraulics {
namespace {

constexpr Range kPoppetAngleRange{.min = 0, .max = 1.5};  // below a flat seat, pi/2

constexpr Field kDirectReliefValveFields[] = {
    field<&DirectReliefValveDef::port_1>(
        "port_1", {.presence = Presence::required, .reference = "volume", .doc = "volume at the inlet"}),
    field<&DirectReliefValveDef::port_2>(
        "port_2", {.presence = Presence::required, .reference = "volume", .doc = "volume at the outlet"}),
    field<&DirectReliefValveDef::seat_diameter>("seat_diameter", {.dimension = Dimension::length,
                                                                  .range = kPositive,
                                                                  .presence = Presence::required,
                                                                  .doc = "diameter of the seat"}),
    field<&DirectReliefValveDef::half_angle>(
        "half_angle",
        {.dimension = Dimension::angle, .range = kPoppetAngleRange, .doc = "half angle of the poppet's cone"}),
    field<&DirectReliefValveDef::crack_pressure>("crack_pressure",
                                                 {.dimension = Dimension::pressure,
                                                  .range = kPositive,
                                                  .presence = Presence::required,
                                                  .change = Change::live,
                                                  .doc = "pressure above the outlet that lifts the poppet"}),
    field<&DirectReliefValveDef::spring_constant>("spring_constant", {.dimension = Dimension::stiffness,
                                                                      .range = kPositive,
                                                                      .presence = Presence::required,
                                                                      .doc = "spring constant"}),
    field<&DirectReliefValveDef::discharge_coefficient>("discharge_coefficient",
                                                        {.range = kFractionAboveZero, .doc = "discharge coefficient"}),
    field<&DirectReliefValveDef::maximum_lift>(
        "maximum_lift", {.dimension = Dimension::length, .range = kPositive, .doc = "lift at the stop"}),
    field<&DirectReliefValveDef::flow_force>("flow_force",
                                             {.choices = kFlowForceChoices, .doc = "closing force of the jet"}),
};

constexpr double kCrackWidth =
    1e-6;  // share of the crack force (lift: of the maximum lift), smoothing of the seat and the stop
constexpr double kOpenDirect = 1e-6;  // m, lift above which the valve counts as open

class DirectReliefValve final : public HydraulicComponent {
 public:
  DirectReliefValve(const DirectReliefValveDef& def, CircuitBuilder& builder)
      : HydraulicComponent(def),
        def_(def),
        p_1_(builder.volume(def.port_1)),
        p_2_(builder.volume(def.port_2)),
        transition_(builder.def().orifice_transition),
        root_2_rho_(std::sqrt(2 / builder.def().oil_density)) {
    apply_parameters();
    const double lifted = def.spring_constant * def.maximum_lift / seat_area_;
    builder.add_relief({.valve = def.name, .volume = p_1_, .outlet = p_2_, .fully_open = def.crack_pressure + lifted});
  }
  void declare_dependencies(DependencyList& dependencies) const override { dependencies.add_restriction(p_1_, p_2_); }
  void add_rates(const CircuitView& view, Rates& rates) const noexcept override {
    rates.move(p_1_, p_2_, flow(view[p_1_] - view[p_2_]).value);
  }
  void add_jacobian(const CircuitView& view, JacobianStamp& jacobian) const noexcept override {
    const double slope = flow(view[p_1_] - view[p_2_]).slope;
    jacobian.move(p_1_, p_2_, p_1_, slope);
    jacobian.move(p_1_, p_2_, p_2_, -slope);
  }
  void raise_slopes(const CircuitView& view, JacobianStamp& slopes) const noexcept override {
    // at the seat the slope jumps: use the open side's
    const double p = view[p_1_] - view[p_2_];
    if (std::fabs(p - def_.crack_pressure) > transition_) return;
    const double open = flow(def_.crack_pressure + transition_).slope, now = flow(p).slope;
    if (open > now) slopes.pass(p_1_, p_2_, open - now);
  }
  [[nodiscard]] std::uint32_t flags(const CircuitView& view) const noexcept override {
    return lift(view[p_1_] - view[p_2_]).value > kOpenDirect ? static_cast<std::uint32_t>(StepFlag::relief_open) : 0;
  }
  void list_variables(std::vector<ElementVariable>& variables) const override {
    variables.push_back(variable("lift", Dimension::length));
    variables.push_back(variable("flow", Dimension::volume_flow));
  }
  double* read_variables(const CircuitView& view, double* values) const noexcept override {
    const double p = view[p_1_] - view[p_2_];
    *values++ = lift(p).value;
    *values++ = flow(p).value;
    return values;
  }
  [[nodiscard]] void* def_address() noexcept override { return &def_; }
  void follow_oil(const PortOil& oil) noexcept override {
    root_2_rho_ = std::sqrt(2 / oil.between(p_1_, p_2_).density);
    apply_parameters();
  }
  void apply_parameters() noexcept override {
    seat_area_ = 0.25 * std::numbers::pi * def_.seat_diameter * def_.seat_diameter;
    const double w = std::numbers::pi * def_.seat_diameter * std::sin(def_.half_angle);
    conductance_ = def_.discharge_coefficient * w * root_2_rho_;
    jet_ = def_.flow_force == FlowForce::included ? 2 * def_.discharge_coefficient * w * std::cos(def_.half_angle) : 0;
  }

 private:
  // y = ramp((p - p_crack) A_p) / (k_s + 2 C_d w p cos alpha), at most the maximum lift
  [[nodiscard]] ValueSlope lift(double p) const noexcept {
    const double crack_force = def_.crack_pressure * seat_area_;
    const ValueSlope force = ramp((p - def_.crack_pressure) * seat_area_, kCrackWidth * crack_force);
    if (force.value <= 0) return {0, 0};
    const double stiffness = def_.spring_constant + jet_ * p;
    const double y = force.value / stiffness;
    const double dy = (force.slope * seat_area_ - y * jet_) / stiffness;
    const ValueSlope limited = smooth_min(y, def_.maximum_lift, kCrackWidth * def_.maximum_lift);
    return {limited.value, limited.slope * dy};
  }
  [[nodiscard]] ValueSlope flow(double p) const noexcept {
    const ValueSlope y = lift(p), r = root(p, transition_);
    return {conductance_ * y.value * r.value, conductance_ * (y.slope * r.value + y.value * r.slope)};
  }

  DirectReliefValveDef def_;
  StateIndex p_1_, p_2_;
  double transition_, root_2_rho_;
  double seat_area_ = 0, conductance_ = 0, jet_ = 0;
};

}  // namespace

void DirectReliefValveDef::add_lines(PumpLines& lines) const {
  if (crack_pressure < OilCompressibility::kHighest) {
    lines.open.push_back({.a = port_1, .b = port_2, .is_one_way = true});
  }
}

ComponentType direct_relief_valve_type() {
  return {.name = "direct_relief_valve",
          .fields = kDirectReliefValveFields,
          .doc = "direct-acting poppet relief valve",
          .make_def = []() -> std::unique_ptr<ComponentDef> { return std::make_unique<DirectReliefValveDef>(); },
          .validate = nullptr,
          .build = [](const ComponentDef& def, CircuitBuilder& builder) -> std::unique_ptr<HydraulicComponent> {
            return std::make_unique<DirectReliefValve>(static_cast<const DirectReliefValveDef&>(def), builder);
          }};
}

}  // namespace slew::hydraulics
