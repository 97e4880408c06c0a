// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/components/engine.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hydraulics/circuit_builder.h"
#include "hydraulics/component.h"
#include "hydraulics/curve.h"
#include "hydraulics/smooth.h"

namespace slew::hydraulics {
namespace {

constexpr Field kEngineFields[] = {
    field<&EngineDef::torque_curve>("torque_curve",
                                    {.presence = Presence::required,
                                     .reference = "curve",
                                     .doc = "torque at full load [Nm] over the speed [rad/s], held beyond the ends"}),
    field<&EngineDef::inertia>("inertia", {.dimension = Dimension::inertia,
                                           .range = kPositive,
                                           .presence = Presence::required,
                                           .doc = "inertia of crankshaft, flywheel and what turns with them"}),
    field<&EngineDef::speed>("speed", {.dimension = Dimension::angular_velocity,
                                       .range = kPositive,
                                       .presence = Presence::required,
                                       .change = Change::live,
                                       .doc = "governed speed at full load without a control signal"}),
    field<&EngineDef::speed_per_signal>("speed_per_signal", {.dimension = Dimension::angular_velocity,
                                                             .change = Change::live,
                                                             .doc = "governed speed per unit of the control signal"}),
    field<&EngineDef::minimum_speed>(
        "minimum_speed",
        {.dimension = Dimension::angular_velocity, .range = kNotNegative, .doc = "least governed speed"}),
    field<&EngineDef::droop>("droop", {.range = kFractionAboveZero,
                                       .change = Change::live,
                                       .doc = "rise of the governed speed from full load to none, as a share"}),
    field<&EngineDef::fuel_time_constant>(
        "fuel_time_constant", {.dimension = Dimension::time,
                               .range = kPositive,
                               .change = Change::live,
                               .doc = "time constant of the torque behind the governor: injection and boost"}),
    field<&EngineDef::stall_speed>("stall_speed", {.dimension = Dimension::angular_velocity,
                                                   .range = kPositive,
                                                   .presence = Presence::required,
                                                   .doc = "speed below which there is no combustion"}),
    field<&EngineDef::friction_torque>("friction_torque", {.dimension = Dimension::torque,
                                                           .range = kNotNegative,
                                                           .change = Change::live,
                                                           .doc = "losses and auxiliaries at any speed"}),
    field<&EngineDef::viscous_friction>("viscous_friction",
                                        {.dimension = Dimension::rotational_damping,
                                         .range = kNotNegative,
                                         .change = Change::live,
                                         .doc = "losses and auxiliaries in proportion to the speed"}),
};

constexpr double kFuelWidth = 0.02;       // share of the fuel, smoothing of the governor's limits
constexpr double kCombustionWidth = 0.1;  // share of g, smoothing
constexpr double kCombustionRange = 0.1;  // share of stall_speed over which combustion sets in
constexpr int kHalvings = 60;             // of the droop, to rounding
constexpr double kFrictionSpeed = 1;      // w_f [rad/s], below which the friction goes to zero
// (5): a load of 250 Nm creeps at 0.1 rad/s on 2 kg m2; rk4 follows it with sub-steps of 2 ms
constexpr double kHoldTime = 1e-3, kHoldWidth = 1e-2;  // tau_h [s], w_h [rad/s]

class Engine final : public HydraulicComponent {
 public:
  Engine(const EngineDef& def, CircuitBuilder& builder)
      : HydraulicComponent(def),
        def_(def),
        shaft_(builder.shaft(def.name)),
        w_(shaft_.speed),
        u_(shaft_.fuel),
        control_(builder.add_control(def.name, SignalMoves::a_state)),
        full_load_(*find_curve(builder.def(), def.torque_curve)) {}

  // at rest under its own losses: (1) and (2) balance between the governed speeds at full load and without any, the
  // latter of an engine that is switched off
  void start(double* y) const noexcept override {
    const double w_s = governed(0);
    double high = (1 + def_.droop) * w_s, low = full_torque(w_s).value > 0 ? w_s : high;
    for (int i = 0; i < kHalvings; ++i) {
      const double w = 0.5 * (low + high);
      (fuel_command(w_s, w).value * full_torque(w).value > loss(w).value ? low : high) = w;
    }
    y[w_] = high / shaft_.reference;
    y[u_] = fuel_command(w_s, high).value;
  }
  void declare_dependencies(DependencyList& dependencies) const override {
    for (const StateIndex row : {w_, u_}) dependencies.add(row, w_), dependencies.add(row, u_);
  }
  // (1), to which the pumps add their loads, and (2)
  void add_rates(const CircuitView& view, Rates& rates) const noexcept override {
    const double w = speed(view);
    rates.add_flow(w_, (view[u_] * full_torque(w).value - loss(w).value) * per_torque());
    rates.set_rate(u_, (fuel_command(view).value - view[u_]) / def_.fuel_time_constant);
  }
  void add_jacobian(const CircuitView& view, JacobianStamp& jacobian) const noexcept override {
    const double w = speed(view);
    const ValueSlope torque = full_torque(w);
    jacobian.add(w_, w_, (view[u_] * torque.slope - loss(w).slope) * per_torque() * shaft_.reference);
    jacobian.add(w_, u_, torque.value * per_torque());
    jacobian.add(u_, w_, fuel_command(view).slope * shaft_.reference / def_.fuel_time_constant);
    jacobian.add(u_, u_, -1 / def_.fuel_time_constant);
  }
  void list_variables(std::vector<ElementVariable>& variables) const override {
    variables.push_back(variable("speed", Dimension::angular_velocity));
    variables.push_back(variable("speed_setting", Dimension::angular_velocity));
    variables.push_back(variable("fuel", Dimension::none));
    variables.push_back(variable("torque", Dimension::torque));
    variables.push_back(variable("available_torque", Dimension::torque));
    variables.push_back(variable("power", Dimension::power));
    variables.push_back(variable("is_stalled", Dimension::none));
  }
  double* read_variables(const CircuitView& view, double* values) const noexcept override {
    const double w = speed(view), available = full_torque(w).value, torque = view[u_] * available - loss(w).value;
    *values++ = w;
    *values++ = governed(view.control[control_]);
    *values++ = view[u_];
    *values++ = torque;
    *values++ = available;
    *values++ = torque * w;
    *values++ = w < def_.stall_speed ? 1 : 0;
    return values;
  }
  [[nodiscard]] void* def_address() noexcept override { return &def_; }
  void apply_parameters() noexcept override {}

 private:
  [[nodiscard]] double speed(const CircuitView& view) const noexcept { return view[w_] * shaft_.reference; }
  // rate of the state per torque [1/(N m s)]
  [[nodiscard]] double per_torque() const noexcept { return 1 / (shaft_.inertia * shaft_.reference); }
  // w_s of (3)
  [[nodiscard]] double governed(double signal) const noexcept {
    return std::max({def_.speed + def_.speed_per_signal * signal, def_.minimum_speed, def_.stall_speed});
  }
  // u_c of (2), with its slope over w
  [[nodiscard]] ValueSlope fuel_command(double w_s, double w) const noexcept {
    const double range = def_.droop * w_s;
    const ValueSlope u = unit_clip((w_s + range - w) / range, kFuelWidth);
    return {u.value, -u.slope / range};
  }
  [[nodiscard]] ValueSlope fuel_command(const CircuitView& view) const noexcept {
    return fuel_command(governed(view.control[control_]), speed(view));
  }
  // T_full g
  [[nodiscard]] ValueSlope full_torque(double w) const noexcept {
    const double range = kCombustionRange * def_.stall_speed;
    const ValueSlope g = unit_clip((w - def_.stall_speed) / range, kCombustionWidth), T = full_load_.at(w);
    return {T.value * g.value, T.slope * g.value + T.value * g.slope / range};
  }
  // friction of (1) and -T_h of (5), with their slope
  [[nodiscard]] ValueSlope loss(double w) const noexcept {
    const double square = w * w + kFrictionSpeed * kFrictionSpeed, length = std::sqrt(square);
    const ValueSlope back = ramp(-w, kHoldWidth);
    const double hold = def_.inertia / kHoldTime;
    return {def_.friction_torque * w / length + def_.viscous_friction * w - hold * back.value,
            def_.friction_torque * kFrictionSpeed * kFrictionSpeed / (square * length) + def_.viscous_friction +
                hold * back.slope};
  }

  EngineDef def_;
  EngineShaft shaft_;
  StateIndex w_, u_;  // speed over its reference, fuel
  int control_;
  CurveFunction full_load_;
};

// A curve over rev/min, typed as in a data sheet, begins far above the engine's speeds.
void warn_of_held_torque(const EngineDef& def, const CurveDef* curve, Problems& warnings) {
  if (curve == nullptr || curve->points.empty()) return;
  const double first = curve->points.front()[0], last = curve->points.back()[0];
  const double speed = std::max(def.speed, def.minimum_speed);
  if (speed >= first && speed <= last) return;
  warnings.push_back(
      {def.name + ".torque_curve",
       fmt::format(
           "the governed speed {:g} rad/s lies outside of the curve '{}', which goes from {:g} to {:g} rad/s: its "
           "{} torque holds there",
           speed, curve->name, first, last, speed < first ? "first" : "last"),
       "arguments in rad/s, 1 rev/min = 0.1047 rad/s, that enclose the speed", ""});
}

void validate_engine(const HydraulicsDef& circuit, const ComponentDef& component, Problems& errors,
                     Problems& warnings) {
  const EngineDef& def = static_cast<const EngineDef&>(component);
  const CurveDef* curve = find_curve(circuit, def.torque_curve);
  if (curve != nullptr) {
    const auto is_negative = [](const auto& point) { return point[1] < 0; };
    if (curve->odd || std::any_of(curve->points.begin(), curve->points.end(), is_negative)) {
      errors.push_back({def.name + ".torque_curve", "the curve '" + curve->name + "' has negative torques",
                        "torques >= 0 over speeds >= 0, without odd: true; losses are friction_torque", ""});
    }
  }
  warn_of_held_torque(def, curve, warnings);
  if (def.speed <= def.stall_speed) {
    errors.push_back(
        {def.name + ".stall_speed", "the engine would stand at its governed speed", "a speed below `speed`", ""});
  }
  const double speed = std::max(def.speed, def.minimum_speed);
  const double loss = def.friction_torque + def.viscous_friction * speed;
  // one without any torque is switched off
  const bool is_on = curve != nullptr && std::any_of(curve->points.begin(), curve->points.end(),
                                                     [](const auto& point) { return point[1] > 0; });
  if (is_on && errors.empty()) {
    const double most = CurveFunction(*curve).at(speed).value;
    if (loss >= most) {
      errors.push_back(
          {def.name + ".friction_torque",
           fmt::format("friction_torque and viscous_friction are {:g} Nm at {:g} rad/s, where the engine has "
                       "{:g} Nm at full load: it cannot turn by itself",
                       loss, speed, most),
           "less friction, or more torque in '" + curve->name + "'", ""});
    }
  }
  const auto is_driven = [&](const auto& other) {
    const std::span<const Field> fields = find_component_type(other->type_name())->fields;
    return std::any_of(fields.begin(), fields.end(), [&](const Field& row) {
      return row.key == "engine" && *static_cast<const std::string*>(row.member(other->address())) == def.name;
    });
  };
  if (std::none_of(circuit.components.begin(), circuit.components.end(), is_driven)) {
    warnings.push_back({def.name, "no pump is driven by the engine", "a pump with engine: " + def.name, ""});
  }
}

}  // namespace

ComponentType engine_type() {
  return {.name = "engine",
          .fields = kEngineFields,
          .doc = "combustion engine with torque curve, governor and inertia that drives pumps",
          .make_def = []() -> std::unique_ptr<ComponentDef> { return std::make_unique<EngineDef>(); },
          .validate = validate_engine,
          .build = [](const ComponentDef& def, CircuitBuilder& builder) -> std::unique_ptr<HydraulicComponent> {
            return std::make_unique<Engine>(static_cast<const EngineDef&>(def), builder);
          },
          .has_control_signal = true};
}

}  // namespace slew::hydraulics
