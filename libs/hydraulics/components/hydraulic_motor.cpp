// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/components/hydraulic_motor.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "hydraulics/circuit_builder.h"
#include "hydraulics/component.h"
#include "hydraulics/components/cylinder_fields.h"
#include "hydraulics/components/cylinder_rules.h"
#include "hydraulics/components/displacement_servo.h"
#include "hydraulics/components/shared_fields.h"
#include "hydraulics/oil_properties.h"
#include "hydraulics/passages.h"

namespace slew::hydraulics {
namespace {

// without tlm: the oil of one step is a large part of the motor's own, and the waves of so small a line exceed its
// pressures
constexpr std::string_view kMotorCouplings[] = {"session", "hold", "linear", "two"};

constexpr ReadBy kReadByCase[] = {read_by_set<&HydraulicMotorDef::port_c>("port_c", "a port_c")};

constexpr ReadBy kReadByLoss[] = {
    {"mechanical_coefficient", "a mechanical_coefficient below 1",
     [](const void* def) noexcept { return static_cast<const HydraulicMotorDef*>(def)->mechanical_coefficient < 1; },
     ReadBy::Otherwise::warning}};
constexpr ReadBy kReadByVariable[] = {read_by<&HydraulicMotorDef::is_variable, true>("variable", "variable: true")};
constexpr ReadBy kReadByBrake[] = {read_by_set<&HydraulicMotorDef::brake_port>("brake_port", "a brake_port")};

constexpr Field kHydraulicMotorFields[] = {
    field<&HydraulicMotorDef::force>(
        "force",
        {.presence = Presence::required, .reference = "force", .doc = "rotational force that the motor drives"}),
    field<&HydraulicMotorDef::port_a>(
        "port_a",
        {.presence = Presence::required, .reference = "volume", .doc = "volume whose pressure turns forwards"}),
    field<&HydraulicMotorDef::port_b>(
        "port_b", {.presence = Presence::required, .reference = "volume", .doc = "volume whose pressure turns back"}),
    field<&HydraulicMotorDef::port_c>(
        "port_c", {.reference = "volume", .doc = "volume of the case drain, without it no leak to the case"}),
    field<&HydraulicMotorDef::displacement>("displacement", {.dimension = Dimension::displacement_volume,
                                                             .range = kPositive,
                                                             .presence = Presence::required,
                                                             .doc = "displacement"}),
    field<&HydraulicMotorDef::gear_ratio>(
        "gear_ratio", {.range = kPositive, .doc = "turns of the shaft per turn of the force element's angle"}),
    field<&HydraulicMotorDef::mechanical_coefficient>(
        "mechanical_coefficient",
        {.range = kFractionAboveZero, .doc = "efficiency eta; 1 - eta of the pressures' torque is lost"}),
    field<&HydraulicMotorDef::friction_curve>(
        "friction_curve",
        {.reference = "curve",
         .read_by = kReadByLoss,
         .doc = "factor of the loss 1 - eta over the shaft's speed [rad/s], from [0, 0] on; without it 1"}),
    field<&HydraulicMotorDef::torque_loss>(
        "torque_loss",
        {.dimension = Dimension::torque, .range = kNotNegative, .doc = "friction at equal pressures, at the shaft"}),
    field<&HydraulicMotorDef::viscous_loss>("viscous_loss", {.dimension = Dimension::rotational_damping,
                                                             .range = kNotNegative,
                                                             .doc = "friction proportional to the shaft's speed"}),
    field<&HydraulicMotorDef::leak_flow>("leak_flow", {.dimension = Dimension::volume_flow,
                                                       .range = kNotNegative,
                                                       .change = Change::live,
                                                       .doc = "leak from port to port at leak_pressure"}),
    field<&HydraulicMotorDef::case_leak_flow>("case_leak_flow",
                                              {.dimension = Dimension::volume_flow,
                                               .range = kNotNegative,
                                               .change = Change::live,
                                               .read_by = kReadByCase,
                                               .doc = "leak from either port to the case at leak_pressure"}),
    field<&HydraulicMotorDef::leak_pressure>(
        "leak_pressure",
        {.dimension = Dimension::pressure, .range = kPositive, .doc = "pressure difference of the leak flows"}),
    field<&HydraulicMotorDef::dead_volume>(
        "dead_volume", {.dimension = Dimension::volume, .range = kPositive, .doc = "oil in the motor on either side"}),
    field<&HydraulicMotorDef::coupling>("coupling",
                                        {.change = Change::live,
                                         .choices = kMotorCouplings,
                                         .doc = "coupling level of this port; session: that of session.coupling"}),
    field<&HydraulicMotorDef::is_variable>("variable",
                                           {.doc = "displacement that follows setting and the control signal"}),
    field<&HydraulicMotorDef::setting>("setting", {.range = kFraction,
                                                   .change = Change::live,
                                                   .read_by = kReadByVariable,
                                                   .doc = "share of the displacement without a control signal"}),
    field<&HydraulicMotorDef::setting_per_signal>("setting_per_signal",
                                                  {.range = kFinite,
                                                   .change = Change::live,
                                                   .read_by = kReadByVariable,
                                                   .doc = "share of the displacement per unit of the control signal"}),
    field<&HydraulicMotorDef::minimum_setting>("minimum_setting", {.range = kFractionAboveZero,
                                                                   .change = Change::live,
                                                                   .read_by = kReadByVariable,
                                                                   .doc = "least share of the displacement"}),
    field<&HydraulicMotorDef::time_constant>("time_constant", {.dimension = Dimension::time,
                                                               .range = kPositive,
                                                               .change = Change::live,
                                                               .read_by = kReadByVariable,
                                                               .doc = "time constant of the displacement"}),
    field<&HydraulicMotorDef::setting_rate_limit>("setting_rate_limit",
                                                  {.dimension = Dimension::frequency,
                                                   .range = kNotNegative,
                                                   .change = Change::live,
                                                   .read_by = kReadByVariable,
                                                   .doc = "greatest rate of the setting; 0: none"}),
    field<&HydraulicMotorDef::brake_port>(
        "brake_port",
        {.reference = "volume", .doc = "volume whose pressure releases the holding brake, without it no brake"}),
    field<&HydraulicMotorDef::brake, &ShaftBrakeParameters::torque>(
        "brake_torque", {.dimension = Dimension::torque,
                         .range = kNotNegative,
                         .read_by = kReadByBrake,
                         .doc = "brake torque at the shaft without pressure"}),
    field<&HydraulicMotorDef::brake, &ShaftBrakeParameters::release_pressure>(
        "brake_release_pressure", {.dimension = Dimension::pressure,
                                   .range = kPositive,
                                   .change = Change::live,
                                   .read_by = kReadByBrake,
                                   .doc = "pressure above the case (above 1 bar without port_c) that opens the brake"}),
    field<&HydraulicMotorDef::brake, &ShaftBrakeParameters::twist>(
        "brake_twist", {.dimension = Dimension::angle,
                        .range = kPositive,
                        .read_by = kReadByBrake,
                        .doc = "turn of the shaft against the brake from no torque to brake_torque"}),
    field<&HydraulicMotorDef::brake, &ShaftBrakeParameters::share>(
        "brake_share", {.range = kFraction,
                        .change = Change::live,
                        .read_by = kReadByBrake,
                        .doc = "share of brake_torque that worn or oily discs still hold"}),
};

constexpr double kAtmosphere = 1e5;  // Pa, in the room of the brake's springs without a case drain

// speed of the shaft from which on its friction is fully there: a gear of 100 turns the joint by 1e-4 rad/s then
constexpr double kRestSpeed = 1e-2;  // rad/s
constexpr FrictionSpeeds kShaftSpeeds{.greatest = 2000, .unit = "rad/s"};
// typical sizes for the error measure: at rtol 1e-4 an error of 1e-5 rad, some 100 Pa of a litre of oil
constexpr double kAngleScale = 0.1;      // rad
constexpr double kShaftSpeedScale = 10;  // rad/s

class HydraulicMotor final : public HydraulicComponent {
 public:
  HydraulicMotor(const HydraulicMotorDef& def, CircuitBuilder& builder)
      : HydraulicComponent(def),
        def_(def),
        a_(builder.volume(def.port_a)),
        b_(builder.volume(def.port_b)),
        case_(def.port_c.empty() ? -1 : builder.volume(def.port_c)),
        actuator_(builder.add_actuator(def.name, def.actuator().value())),
        x_(builder.position(actuator_)),
        v_(builder.speed(actuator_)) {
    if (def.is_variable) {
      const double at_start = commanded(0);
      setting_ = builder.add_state({.initial = at_start, .scale = 1});
      control_ = builder.add_control(def.name, SignalMoves::a_state);
      builder.set_setting(actuator_, {setting_, at_start});
    }
    if (!def.brake_port.empty()) {
      brake_port_ = builder.volume(def.brake_port);
      brake_ = builder.add_state({.initial = 0, .scale = 1});
      builder.set_brake(actuator_, {brake_, def.brake.torque});
    }
    // the shaft moves oil through either side, whose content stays
    for (const auto& [port, D] : {std::pair(a_, def.displacement), std::pair(b_, -def.displacement)}) {
      builder.add_content({.volume_index = port,
                           .volume = def.dead_volume,
                           .position = x_,
                           .swept_by_position = D,
                           .setting = setting_});
    }
    apply_parameters();
  }

  void declare_dependencies(DependencyList& dependencies) const override {
    dependencies.add_restriction(a_, b_);
    dependencies.add(a_, v_), dependencies.add(b_, v_);
    if (setting_ >= 0) {
      for (const StateIndex row : {a_, b_, setting_}) dependencies.add(row, setting_);
    }
    if (brake_ >= 0) {
      for (const StateIndex column : {brake_, v_, brake_port_}) dependencies.add(brake_, column);
      if (case_ >= 0) dependencies.add(brake_, case_);
    }
    if (case_ < 0) return;
    dependencies.add_restriction(a_, case_), dependencies.add_restriction(b_, case_);
  }
  void add_rates(const CircuitView& view, Rates& rates) const noexcept override {
    rates.move(a_, b_, displacement(view) * view[v_] + leak(view));
    if (setting_ >= 0) rates.set_rate(setting_, setting_rate(view).value);
    if (brake_ >= 0) rates.set_rate(brake_, brake_rate(view).value);
    if (case_ < 0) return;
    rates.move(a_, case_, case_leak(view, a_));
    rates.move(b_, case_, case_leak(view, b_));
  }
  void add_jacobian(const CircuitView& view, JacobianStamp& jacobian) const noexcept override {
    jacobian.move(a_, b_, v_, displacement(view));
    jacobian.move(a_, b_, a_, G_);
    jacobian.move(a_, b_, b_, -G_);
    if (setting_ >= 0) {
      jacobian.move(a_, b_, setting_, def_.displacement * view[v_]);
      jacobian.add(setting_, setting_, -setting_rate(view).slope);
    }
    if (brake_ >= 0) {
      const BrakeRate rate = brake_rate(view);
      jacobian.add(brake_, brake_, rate.over_b);
      jacobian.add(brake_, v_, rate.over_speed);
      jacobian.add(brake_, brake_port_, rate.over_pressure);
      if (case_ >= 0) jacobian.add(brake_, case_, -rate.over_pressure);
    }
    if (case_ < 0) return;
    for (const StateIndex port : {a_, b_}) {
      jacobian.move(port, case_, port, G_case_);
      jacobian.move(port, case_, case_, -G_case_);
    }
  }
  void list_variables(std::vector<ElementVariable>& variables) const override {
    variables.push_back(variable("angle", Dimension::angle));
    variables.push_back(variable("speed", Dimension::angular_velocity));
    variables.push_back(variable("pressure_a", Dimension::pressure));
    variables.push_back(variable("pressure_b", Dimension::pressure));
    variables.push_back(variable("pressure_torque", Dimension::torque));
    variables.push_back(variable("shaft_torque", Dimension::torque));
    variables.push_back(variable("torque", Dimension::torque));
    variables.push_back(variable("flow_a", Dimension::volume_flow));
    variables.push_back(variable("flow_b", Dimension::volume_flow));
    variables.push_back(variable("case_flow", Dimension::volume_flow));
    variables.push_back(variable("power", Dimension::power));
    variables.push_back(variable("setting", Dimension::none));
    variables.push_back(variable("brake_torque", Dimension::torque));
    variables.push_back(variable("brake_capacity", Dimension::torque));
  }
  double* read_variables(const CircuitView& view, double* values) const noexcept override {
    const double v = view[v_], D = displacement(view), through = D * v + leak(view);
    const double shaft_torque = view.line_force[actuator_];
    const double drain_a = case_ < 0 ? 0 : case_leak(view, a_), drain_b = case_ < 0 ? 0 : case_leak(view, b_);
    *values++ = view[x_];
    *values++ = v;
    *values++ = view[a_];
    *values++ = view[b_];
    *values++ = (view[a_] - view[b_]) * D;
    *values++ = shaft_torque;
    *values++ = def_.gear_ratio * shaft_torque;
    // into the motor
    *values++ = through + drain_a;
    *values++ = -through + drain_b;
    *values++ = drain_a + drain_b;
    *values++ = shaft_torque * v;
    *values++ = setting_ < 0 ? 1 : view[setting_];
    *values++ = brake_ < 0 ? 0 : def_.brake.torque * view[brake_];
    *values++ = brake_ < 0 ? 0 : def_.brake.torque * brake_share(view);
    return values;
  }
  [[nodiscard]] double brake_share(const CircuitView& view) const noexcept override {
    return shaft_brake::held_share(def_.brake, release(view)).value;
  }
  [[nodiscard]] double brake_grip(const CircuitView& view) const noexcept override {
    return shaft_brake::grip(brake_share(view)).value / def_.brake.twist;
  }
  // the shaft takes the work of the pressures
  [[nodiscard]] double shaft_power(const CircuitView& view) const noexcept override {
    return -(view[a_] - view[b_]) * displacement(view) * view[v_];
  }
  // what leaks to the case does not mix with the oil that goes through
  void add_passages(const CircuitView& view, Passages& passages) const noexcept override {
    passages.move(a_, b_, displacement(view) * view[v_] + leak(view), shaft_power(view));
    if (case_ < 0) return;
    for (const StateIndex port : {a_, b_}) passages.move(port, case_, case_leak(view, port));
  }
  void follow_oil(const PortOil& oil) noexcept override {
    fluidity_ = oil.fluidity(a_, b_);
    apply_parameters();
  }
  [[nodiscard]] void* def_address() noexcept override { return &def_; }
  void apply_parameters() noexcept override {
    G_ = fluidity_ * def_.leak_flow / def_.leak_pressure;
    G_case_ = fluidity_ * def_.case_leak_flow / def_.leak_pressure;
  }

 private:
  // (6)
  [[nodiscard]] double commanded(double signal) const noexcept {
    return std::clamp(def_.setting + def_.setting_per_signal * signal, def_.minimum_setting, 1.0);
  }
  // (5)
  [[nodiscard]] ValueSlope setting_rate(const CircuitView& view) const noexcept {
    const double error = commanded(view.control[control_]) - view[setting_];
    return servo_rate(error, def_.time_constant, def_.setting_rate_limit);
  }
  [[nodiscard]] double displacement(const CircuitView& view) const noexcept {
    return setting_ < 0 ? def_.displacement : view[setting_] * def_.displacement;
  }
  // p_x - p_c
  [[nodiscard]] double release(const CircuitView& view) const noexcept {
    return view[brake_port_] - (case_ < 0 ? kAtmosphere : view[case_]);
  }
  [[nodiscard]] BrakeRate brake_rate(const CircuitView& view) const noexcept {
    return shaft_brake::rate(def_.brake, view[brake_], view[v_], release(view));
  }
  [[nodiscard]] double leak(const CircuitView& view) const noexcept { return G_ * (view[a_] - view[b_]); }
  [[nodiscard]] double case_leak(const CircuitView& view, StateIndex port) const noexcept {
    return G_case_ * (view[port] - view[case_]);
  }

  HydraulicMotorDef def_;
  StateIndex a_, b_, case_;  // case: -1 without a drain
  int actuator_;
  StateIndex x_, v_;
  StateIndex setting_ = -1, brake_ = -1, brake_port_ = -1;  // -1: fixed displacement, no brake
  int control_ = -1;
  double G_ = 0, G_case_ = 0;  // m3/s/Pa
  double fluidity_ = 1;        // of the oil, for leaks
};

void validate_motor(const HydraulicsDef& circuit, const ComponentDef& component, Problems& errors, Problems& warnings) {
  const HydraulicMotorDef& def = static_cast<const HydraulicMotorDef&>(component);
  check_distinct(def.name + ".port_b", def.port_a, def.port_b, errors);
  check_friction_curve(circuit, def.name, def.friction_curve, kShaftSpeeds, errors, warnings);
  if (def.brake_port.empty()) return;
  if (def.brake.torque == 0) {
    errors.push_back({def.name + ".brake_torque", "the brake has no torque", "a torque above 0, or no brake_port", ""});
  }
  if (circuit.solver == Solver::rk4) {
    errors.push_back({def.name + ".brake_port", "the discs of a brake slip faster than the sub-steps of rk4",
                      "hydraulics.solver: rodas3, implicit_euler or cvode", ""});
  }
}

}  // namespace

std::optional<ActuatorDef> HydraulicMotorDef::actuator() const {
  constexpr double kNoStop = std::numeric_limits<double>::infinity();
  return ActuatorDef{.force = force,
                     .port_a = port_a,
                     .port_b = port_b,
                     .area_a = displacement,
                     .area_b = displacement,
                     .motion = Motion::rotary,
                     .coordinate = {.ratio = gear_ratio, .unit = PortUnit::radian},
                     .line_force = {.friction_curve = friction_curve,
                                    .cylinder_coefficient = mechanical_coefficient,
                                    .seal_friction = torque_loss,
                                    .viscous_friction = viscous_loss,
                                    .minimum_stroke = -kNoStop,
                                    .maximum_stroke = kNoStop,
                                    .seal_speed = kRestSpeed,
                                    .friction_without_curve = FrictionWithoutCurve::constant},
                     .coupling = coupling,
                     .start = StartRule::mean_pressure,
                     .position_scale = kAngleScale,
                     .speed_scale = kShaftSpeedScale};
}

ComponentType hydraulic_motor_type() {
  return {
      .name = "hydraulic_motor",
      .fields = kHydraulicMotorFields,
      .doc =
          "motor of fixed or variable displacement, with or without a holding brake, that turns a joint through a gear",
      .make_def = []() -> std::unique_ptr<ComponentDef> { return std::make_unique<HydraulicMotorDef>(); },
      .validate = validate_motor,
      .build = [](const ComponentDef& def, CircuitBuilder& builder) -> std::unique_ptr<HydraulicComponent> {
        return std::make_unique<HydraulicMotor>(static_cast<const HydraulicMotorDef&>(def), builder);
      },
      .has_control_signal = true};
}

}  // namespace slew::hydraulics
