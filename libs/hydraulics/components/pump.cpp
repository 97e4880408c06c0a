// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/components/pump.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "hydraulics/circuit_builder.h"
#include "hydraulics/component.h"
#include "hydraulics/components/displacement_servo.h"
#include "hydraulics/components/shared_fields.h"
#include "hydraulics/oil_properties.h"
#include "hydraulics/passages.h"
#include "hydraulics/pump_lines.h"
#include "hydraulics/smooth.h"

namespace slew::hydraulics {
namespace {

constexpr ReadBy kReadByCutOff[] = {read_by_set<&PumpDef::maximum_pressure>("maximum_pressure", "a maximum_pressure")};

constexpr ReadBy kPumpReadBySpeed[] = {{"engine", "no engine", [](const void* def) noexcept {
                                          return static_cast<const PumpDef*>(def)->drive.engine.empty();
                                        }}};
constexpr ReadBy kPumpReadByEngine[] = {{"engine", "an engine", [](const void* def) noexcept {
                                           return !static_cast<const PumpDef*>(def)->drive.engine.empty();
                                         }}};

constexpr ReadBy kReadByControl[] = {read_by_set<&PumpDef::control_port>("control_port", "a control_port")};
constexpr ReadBy kPumpReadByCase[] = {read_by_set<&PumpDef::port_c>("port_c", "a port_c")};
constexpr Range kSwashRange{.min = -1, .max = 1, .min_is_open = false, .max_is_open = false};
constexpr Range kLeastSwash{.min = -1, .max = 0, .min_is_open = false, .max_is_open = false};

constexpr Field kPumpFields[] = {
    field<&PumpDef::port_a>("port_a",
                            {.presence = Presence::required, .reference = "volume", .doc = "volume at the outlet"}),
    field<&PumpDef::port_b>(
        "port_b", {.presence = Presence::required, .reference = "volume", .doc = "volume at the inlet, the tank"}),
    field<&PumpDef::port_c>("port_c",
                            {.reference = "volume", .doc = "volume of the case drain, without it no leak to the case"}),
    field<&PumpDef::speed>("speed", {.dimension = Dimension::angular_velocity,
                                     .range = kNotNegative,
                                     .change = Change::live,
                                     .read_by = kPumpReadBySpeed,
                                     .doc = "speed of the drive; required without an engine"}),
    field<&PumpDef::drive, &PumpDriveParameters::engine>(
        "engine", {.reference = "component", .doc = "engine that drives the pump"}),
    field<&PumpDef::drive, &PumpDriveParameters::speed_ratio>(
        "speed_ratio",
        {.range = kPositive, .read_by = kPumpReadByEngine, .doc = "speed of the pump over that of the engine"}),
    field<&PumpDef::displacement>("displacement", {.dimension = Dimension::displacement_volume,
                                                   .range = kPositive,
                                                   .presence = Presence::required,
                                                   .doc = "displacement at full swash"}),
    field<&PumpDef::mechanical_coefficient>("mechanical_coefficient",
                                            {.range = kFractionAboveZero, .doc = "hydro-mechanical efficiency"}),
    field<&PumpDef::volumetric_coefficient>("volumetric_coefficient",
                                            {.range = kFractionAboveZero, .doc = "volumetric efficiency"}),
    field<&PumpDef::swash>(
        "swash",
        {.range = kSwashRange, .change = Change::live, .doc = "share of the displacement without a control signal"}),
    field<&PumpDef::minimum_swash>(
        "minimum_swash", {.range = kLeastSwash, .doc = "least share; below 0: the pump delivers over centre too"}),
    field<&PumpDef::swash_per_signal>(
        "swash_per_signal",
        {.range = kFinite, .change = Change::live, .doc = "share of the displacement per unit of the control signal"}),
    field<&PumpDef::time_constant>("time_constant", {.dimension = Dimension::time,
                                                     .range = kPositive,
                                                     .change = Change::live,
                                                     .doc = "time constant of the swash"}),
    field<&PumpDef::swash_rate_limit>("swash_rate_limit", {.dimension = Dimension::frequency,
                                                           .range = kNotNegative,
                                                           .change = Change::live,
                                                           .doc = "greatest rate of the swash; 0: none"}),
    field<&PumpDef::maximum_pressure>("maximum_pressure",
                                      {.dimension = Dimension::pressure,
                                       .range = kNotNegative,
                                       .change = Change::live,
                                       .doc = "pressure above tank at which the cut-off ends the flow; 0: none"}),
    field<&PumpDef::controller_gain>("controller_gain", {.dimension = Dimension::pressure_gain,
                                                         .range = kPositive,
                                                         .read_by = kReadByCutOff,
                                                         .doc = "swash per pressure below maximum_pressure"}),
    field<&PumpDef::maximum_power>("maximum_power", {.dimension = Dimension::power,
                                                     .range = kNotNegative,
                                                     .change = Change::live,
                                                     .doc = "limit of the drive's power; 0: none"}),
    field<&PumpDef::control_port>(
        "control_port",
        {.reference = "volume", .doc = "volume whose pressure sets the swash (negative or positive control)"}),
    field<&PumpDef::full_swash_pressure>("full_swash_pressure",
                                         {.dimension = Dimension::pressure,
                                          .range = kNotNegative,
                                          .read_by = kReadByControl,
                                          .doc = "pressure of control_port above port_b that gives the full swash"}),
    field<&PumpDef::zero_swash_pressure>(
        "zero_swash_pressure",
        {.dimension = Dimension::pressure,
         .range = kNotNegative,
         .read_by = kReadByControl,
         .doc = "pressure that gives no swash; above full_swash_pressure: negative control, below: positive"}),
    field<&PumpDef::leak_flow>("leak_flow", {.dimension = Dimension::volume_flow,
                                             .range = kNotNegative,
                                             .change = Change::live,
                                             .doc = "leak from outlet to tank at leak_pressure"}),
    field<&PumpDef::case_leak_flow>("case_leak_flow", {.dimension = Dimension::volume_flow,
                                                       .range = kNotNegative,
                                                       .change = Change::live,
                                                       .read_by = kPumpReadByCase,
                                                       .doc = "leak from either port to the case at leak_pressure"}),
    field<&PumpDef::leak_pressure>(
        "leak_pressure",
        {.dimension = Dimension::pressure, .range = kPositive, .doc = "pressure difference of the leak flows"}),
};

constexpr double kSwashWidth = 0.01;  // share of the swash, smoothing of its limits

class Pump final : public HydraulicComponent {
 public:
  Pump(const PumpDef& def, CircuitBuilder& builder)
      : HydraulicComponent(def),
        def_(def),
        a_(builder.volume(def.port_a)),
        b_(builder.volume(def.port_b)),
        case_(def.port_c.empty() ? -1 : builder.volume(def.port_c)),
        pilot_(def.control_port.empty() ? -1 : builder.volume(def.control_port)),
        control_(builder.add_control(def.name, SignalMoves::a_state)),
        alpha_(builder.add_state({.initial = def.swash, .scale = 1})),
        drive_(def.drive, def.displacement, def.mechanical_coefficient, def.volumetric_coefficient, builder) {
    builder.mark_supply(a_);
    apply_parameters();
  }
  // at the command's swash under the start pressures
  void start(double* y) const noexcept override {
    y[alpha_] = limited(def_.swash, y[a_] - y[b_], drive_.at_start(def_.speed), by_pilot(y)).value;
  }
  void declare_dependencies(DependencyList& dependencies) const override {
    dependencies.add_restriction(a_, b_);
    if (case_ >= 0) dependencies.add_restriction(a_, case_), dependencies.add_restriction(b_, case_);
    for (const StateIndex port : {a_, b_}) dependencies.add(port, alpha_), dependencies.add(alpha_, port);
    dependencies.add(alpha_, alpha_);
    if (pilot_ >= 0) dependencies.add(alpha_, pilot_);
    drive_.declare_dependencies(a_, b_, alpha_, dependencies);
  }
  void add_rates(const CircuitView& view, Rates& rates) const noexcept override {
    rates.set_rate(alpha_, swash_rate(view, limited_at(view).value).value);
    rates.move(b_, a_, flow(view));
    drive_.add_load(view[alpha_], rise(view), view, rates);
    if (case_ < 0) return;
    for (const StateIndex port : {a_, b_}) rates.move(port, case_, G_case_ * (view[port] - view[case_]));
  }
  void add_jacobian(const CircuitView& view, JacobianStamp& jacobian) const noexcept override {
    const Swash least = limited_at(view);
    const double rate = swash_rate(view, least.value).slope, d_rise = rate * least.over_rise;
    jacobian.add(alpha_, alpha_, -rate);
    jacobian.add(alpha_, a_, d_rise);
    jacobian.add(alpha_, b_, -d_rise);
    if (pilot_ >= 0) {
      const double d_pilot = rate * least.over_pilot;
      jacobian.add(alpha_, pilot_, d_pilot);
      jacobian.add(alpha_, b_, -d_pilot);
    }
    const PumpDrive::Displaced displaced = drive_.displaced(view[alpha_], rise(view), view);
    const double G = G_leak_ - per_speed_ * speed(view) * view[alpha_] * displaced.over_rise;
    jacobian.move(b_, a_, alpha_, per_speed_ * speed(view) * displaced.value);
    jacobian.move(b_, a_, a_, -G);
    jacobian.move(b_, a_, b_, G);
    drive_.stamp(a_, b_, alpha_, view, per_speed_, jacobian);
    drive_.stamp_speed(alpha_, rate * least.over_speed, jacobian);
    if (case_ < 0) return;
    for (const StateIndex port : {a_, b_}) {
      jacobian.move(port, case_, port, G_case_);
      jacobian.move(port, case_, case_, -G_case_);
    }
  }
  void list_variables(std::vector<ElementVariable>& variables) const override {
    variables.push_back(variable("swash", Dimension::none));
    variables.push_back(variable("flow", Dimension::volume_flow));
    variables.push_back(variable("torque", Dimension::torque));
    variables.push_back(variable("power", Dimension::power));
    if (case_ >= 0) variables.push_back(variable("case_flow", Dimension::volume_flow));
  }
  double* read_variables(const CircuitView& view, double* values) const noexcept override {
    const double torque = drive_.torque(view[alpha_], rise(view), view);
    *values++ = view[alpha_];
    *values++ = flow(view);
    *values++ = torque;
    *values++ = torque * speed(view);
    if (case_ >= 0) *values++ = G_case_ * (view[a_] + view[b_] - 2 * view[case_]);
    return values;
  }
  // what leaks to the case does not mix with the delivered oil
  void add_passages(const CircuitView& view, Passages& passages) const noexcept override {
    passages.move(b_, a_, flow(view), shaft_power(view));
    if (case_ < 0) return;
    for (const StateIndex port : {a_, b_}) passages.move(port, case_, G_case_ * (view[port] - view[case_]));
  }
  void follow_oil(const PortOil& oil) noexcept override {
    fluidity_ = oil.fluidity(a_, b_);
    apply_parameters();
  }
  [[nodiscard]] double shaft_power(const CircuitView& view) const noexcept override {
    return drive_.torque(view[alpha_], rise(view), view) * speed(view);
  }
  [[nodiscard]] void* def_address() noexcept override { return &def_; }
  void apply_parameters() noexcept override {
    per_speed_ = def_.displacement * def_.volumetric_coefficient;
    G_leak_ = fluidity_ * def_.leak_flow / def_.leak_pressure;
    G_case_ = fluidity_ * def_.case_leak_flow / def_.leak_pressure;
  }

 private:
  [[nodiscard]] double rise(const CircuitView& view) const noexcept { return view[a_] - view[b_]; }
  // (3)
  [[nodiscard]] double command(const CircuitView& view) const noexcept {
    return std::fmin(std::fmax(def_.swash + def_.swash_per_signal * view.control[control_], def_.minimum_swash), 1);
  }
  [[nodiscard]] double speed(const CircuitView& view) const noexcept { return drive_.speed(view, def_.speed); }
  // Rise at which the full swash takes the whole power at the speed n; 0: no limit.
  [[nodiscard]] double full_power_rise(double n) const noexcept {
    const double rate = def_.displacement * n;
    return def_.maximum_power > 0 && rate > 0 ? def_.mechanical_coefficient * def_.maximum_power / rate : 0;
  }
  // (6) over the pressures y
  [[nodiscard]] ValueSlope by_pilot(const double* y) const noexcept {
    if (pilot_ < 0) return {1, 0};
    const double per_pressure = 1 / (def_.zero_swash_pressure - def_.full_swash_pressure);
    const double open = (def_.zero_swash_pressure - (y[pilot_] - y[b_])) * per_pressure;
    const ValueSlope u = unit_clip(open, kSwashWidth);
    return {u.value, -u.slope * per_pressure};
  }
  struct Swash {
    double value, over_rise, over_speed, over_pilot;
    double over_command = 1;
  };
  [[nodiscard]] Swash limited_at(const CircuitView& view) const noexcept {
    return limited(command(view), rise(view), speed(view), by_pilot(view.y));
  }
  // the command of (2) within its limits, with its slopes over the pressure rise p, the speed n and the pilot pressure
  [[nodiscard]] Swash limited(double command, double p, double n, ValueSlope pilot) const noexcept {
    const Swash forth = limited_above(command, p, n, pilot);
    if (def_.minimum_swash == 0) return forth;
    const Swash back = limited_above(-forth.value, -p, n, pilot);
    return {-back.value, back.over_command * forth.over_rise + back.over_rise,
            back.over_command * forth.over_speed - back.over_speed,
            back.over_command * forth.over_pilot - back.over_pilot, 1};
  }
  // for delivery out of port a
  [[nodiscard]] Swash limited_above(double command, double p, double n, ValueSlope pilot) const noexcept {
    Swash alpha{command, 0, 0, 0};
    if (def_.maximum_pressure > 0) {
      const double gain = def_.controller_gain;
      const ValueSlope u = unit_clip(gain * (def_.maximum_pressure - p), kSwashWidth);
      const ValueSlope least = smooth_min(alpha.value, u.value, kSwashWidth);
      alpha = {least.value, -(1 - least.slope) * u.slope * gain, 0, 0, least.slope};
    }
    if (pilot_ >= 0) {
      const ValueSlope least = smooth_min(alpha.value, pilot.value, kSwashWidth);
      alpha = {least.value, least.slope * alpha.over_rise, 0, (1 - least.slope) * pilot.slope,
               least.slope * alpha.over_command};
    }
    // below half of that rise the limit is far above the full swash
    const double full = full_power_rise(n);
    if (full > 0 && p > 0.5 * full) {
      const double u = full / p;
      const ValueSlope least = smooth_min(alpha.value, u, kSwashWidth);
      alpha = {least.value, least.slope * alpha.over_rise - (1 - least.slope) * u / p, -(1 - least.slope) * u / n,
               least.slope * alpha.over_pilot, least.slope * alpha.over_command};
    }
    return alpha;
  }
  // (2) towards the least command
  [[nodiscard]] ValueSlope swash_rate(const CircuitView& view, double least) const noexcept {
    return servo_rate(least - view[alpha_], def_.time_constant, def_.swash_rate_limit);
  }
  // (1)
  [[nodiscard]] double flow(const CircuitView& view) const noexcept {
    const double p = rise(view), displaced = drive_.displaced(view[alpha_], p, view).value;
    return per_speed_ * speed(view) * view[alpha_] * displaced - G_leak_ * p;
  }

  PumpDef def_;
  StateIndex a_, b_;
  StateIndex case_;   // -1: no case drain
  StateIndex pilot_;  // -1: no control port
  int control_;
  StateIndex alpha_;  // swash minimum_swash..1
  PumpDrive drive_;
  double per_speed_ = 0;            // m3/rad, flow per speed at full swash
  double G_leak_ = 0, G_case_ = 0;  // m3/s/Pa
  double fluidity_ = 1;             // of the leaks
};

void validate_plain_pump(const HydraulicsDef& circuit, const ComponentDef& component, Problems& errors, Problems&) {
  const PumpDef& def = static_cast<const PumpDef&>(component);
  check_distinct(def.name + ".port_b", def.port_a, def.port_b, errors);
  if (!def.port_c.empty()) {
    check_distinct(def.name + ".port_c", def.port_a, def.port_c, errors);
    check_distinct(def.name + ".port_c", def.port_b, def.port_c, errors);
  }
  if (def.swash < def.minimum_swash) {
    errors.push_back({def.name + ".swash", fmt::format("the swash {:g} lies below its least one", def.swash),
                      "a swash of at least minimum_swash; below 0 for a pump over centre", ""});
  }
  if (!def.control_port.empty() && def.full_swash_pressure == def.zero_swash_pressure) {
    errors.push_back({def.name + ".zero_swash_pressure", "the swash has no range of control pressures",
                      "zero_swash_pressure above full_swash_pressure for negative control, below for positive", ""});
  }
  check_drive(circuit, def.name, def.drive, def.speed, errors);
}

}  // namespace

void PumpDef::add_lines(PumpLines& lines) const {
  lines.supply.insert(port_a);
  const double flow = greatest_speed(drive, speed) * displacement * volumetric_coefficient;
  const double pressure = maximum_pressure > 0 ? maximum_pressure : std::numeric_limits<double>::infinity();
  lines.pumps.push_back({.name = name, .outlet = port_a, .inlet = port_b, .flow = flow, .pressure = pressure});
  if (minimum_swash < 0) {
    lines.pumps.push_back({.name = name,
                           .outlet = port_b,
                           .inlet = port_a,
                           .key = "port_b",
                           .flow = -minimum_swash * flow,
                           .pressure = pressure});
  }
}

ComponentType pump_type() {
  return {
      .name = "pump",
      .fields = kPumpFields,
      .doc = "pump of fixed or variable displacement with limits of pressure and power, negative or positive control",
      .make_def = []() -> std::unique_ptr<ComponentDef> { return std::make_unique<PumpDef>(); },
      .validate = validate_plain_pump,
      .build = [](const ComponentDef& def, CircuitBuilder& builder) -> std::unique_ptr<HydraulicComponent> {
        return std::make_unique<Pump>(static_cast<const PumpDef&>(def), builder);
      },
      .has_control_signal = true};
}

}  // namespace slew::hydraulics
