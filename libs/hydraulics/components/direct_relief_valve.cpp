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

constexpr auto kDirectReliefValveFields = with_proportional<DirectReliefValveDef>(std::array{
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
});

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
        setting_(def, builder),
        transition_(builder.def().orifice_transition),
        root_2_rho_(std::sqrt(2 / builder.def().oil_density)) {
    apply_parameters();
    const double lifted = def.spring_constant * def.maximum_lift / seat_area_;
    builder.add_relief({.valve = def.name, .volume = p_1_, .outlet = p_2_, .fully_open = def.crack_pressure + lifted});
  }
  void declare_dependencies(DependencyList& dependencies) const override {
    dependencies.add_restriction(p_1_, p_2_);
    setting_.declare(dependencies);
    if (setting_.is_used()) dependencies.add(p_1_, setting_.state()), dependencies.add(p_2_, setting_.state());
  }
  void add_rates(const CircuitView& view, Rates& rates) const noexcept override {
    rates.move(p_1_, p_2_, flow(view[p_1_] - view[p_2_], set_pressure(view).value).value);
    setting_.add_rate(view, def_.solenoid, rates);
  }
  void add_jacobian(const CircuitView& view, JacobianStamp& jacobian) const noexcept override {
    const ValueSlope set = set_pressure(view);
    const Slopes Q = flow(view[p_1_] - view[p_2_], set.value);
    jacobian.move(p_1_, p_2_, p_1_, Q.slope);
    jacobian.move(p_1_, p_2_, p_2_, -Q.slope);
    setting_.stamp_rate(def_.solenoid, jacobian);
    if (setting_.is_used()) jacobian.move(p_1_, p_2_, setting_.state(), Q.by_setting * set.slope);
  }
  void raise_slopes(const CircuitView& view, JacobianStamp& slopes) const noexcept override {
    // at the seat the slope jumps: use the open side's
    const double p = view[p_1_] - view[p_2_], crack = set_pressure(view).value;
    if (std::fabs(p - crack) > transition_) return;
    const double open = flow(crack + transition_, crack).slope, now = flow(p, crack).slope;
    if (open > now) slopes.pass(p_1_, p_2_, open - now);
  }
  [[nodiscard]] std::uint32_t flags(const CircuitView& view) const noexcept override {
    return lift(view[p_1_] - view[p_2_], set_pressure(view).value).value > kOpenDirect
               ? static_cast<std::uint32_t>(StepFlag::relief_open)
               : 0;
  }
  void list_variables(std::vector<ElementVariable>& variables) const override {
    variables.push_back(variable("lift", Dimension::length));
    variables.push_back(variable("flow", Dimension::volume_flow));
    if (setting_.is_used()) variables.push_back(variable("set_pressure", Dimension::pressure));
  }
  double* read_variables(const CircuitView& view, double* values) const noexcept override {
    const double p = view[p_1_] - view[p_2_], crack = set_pressure(view).value;
    *values++ = lift(p, crack).value;
    *values++ = flow(p, crack).value;
    if (setting_.is_used()) *values++ = crack;
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
  // A value over p and over the crack pressure.
  struct Slopes {
    double value, slope, by_setting;
  };
  [[nodiscard]] ValueSlope set_pressure(const CircuitView& view) const noexcept {
    return setting_.pressure(view, def_.solenoid, def_.crack_pressure);
  }
  // y = ramp((p - p_crack) A_p) / (k_s + 2 C_d w p cos alpha), at most the maximum lift
  [[nodiscard]] Slopes lift(double p, double crack) const noexcept {
    const double crack_force = def_.crack_pressure * seat_area_;
    const ValueSlope force = ramp((p - crack) * seat_area_, kCrackWidth * crack_force);
    if (force.value <= 0) return {0, 0, 0};
    const double stiffness = def_.spring_constant + jet_ * p;
    const double y = force.value / stiffness;
    const double dy = (force.slope * seat_area_ - y * jet_) / stiffness;
    const ValueSlope limited = smooth_min(y, def_.maximum_lift, kCrackWidth * def_.maximum_lift);
    return {limited.value, limited.slope * dy, -limited.slope * force.slope * seat_area_ / stiffness};
  }
  [[nodiscard]] Slopes flow(double p, double crack) const noexcept {
    const Slopes y = lift(p, crack);
    const ValueSlope r = root(p, transition_);
    return {conductance_ * y.value * r.value, conductance_ * (y.slope * r.value + y.value * r.slope),
            conductance_ * y.by_setting * r.value};
  }

  DirectReliefValveDef def_;
  StateIndex p_1_, p_2_;
  ProportionalSetting setting_;
  double transition_, root_2_rho_;
  double seat_area_ = 0, conductance_ = 0, jet_ = 0;
};

void validate_direct_relief_valve(const HydraulicsDef&, const ComponentDef& component, Problems& errors, Problems&) {
  const DirectReliefValveDef& def = static_cast<const DirectReliefValveDef&>(component);
  check_minimum_pressure(def, def.crack_pressure, "crack_pressure", errors);
}

}  // namespace

void DirectReliefValveDef::add_lines(PumpLines& lines) const {
  lines.limits.push_back({name, port_1, port_2, crack_pressure});
  if (crack_pressure < OilCompressibility::kHighest) {
    lines.open.push_back({.a = port_1, .b = port_2, .is_one_way = true});
  }
}

ComponentType direct_relief_valve_type() {
  return {.name = "direct_relief_valve",
          .fields = kDirectReliefValveFields,
          .doc = "direct-acting poppet relief valve, at a setting or by a control signal",
          .make_def = []() -> std::unique_ptr<ComponentDef> { return std::make_unique<DirectReliefValveDef>(); },
          .validate = validate_direct_relief_valve,
          .build = [](const ComponentDef& def, CircuitBuilder& builder) -> std::unique_ptr<HydraulicComponent> {
            return std::make_unique<DirectReliefValve>(static_cast<const DirectReliefValveDef&>(def), builder);
          },
          .has_control_signal = true};
}

}  // namespace slew::hydraulics
