// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/components/pump.h"

#include <cmath>
#include <limits>

#include "hydraulics/circuit_builder.h"
#include "hydraulics/component.h"
#include "hydraulics/components/check_poppet.h"
#include "hydraulics/components/displacement_servo.h"
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

constexpr Field kPumpFields[] = {
    field<&PumpDef::port_a>("port_a",
                            {.presence = Presence::required, .reference = "volume", .doc = "volume at the outlet"}),
    field<&PumpDef::port_b>(
        "port_b", {.presence = Presence::required, .reference = "volume", .doc = "volume at the inlet: tank"}),
    field<&PumpDef::speed>("speed", {.dimension = Dimension::angular_velocity,
                                     .range = kNotNegative,
                                     .change = Change::live,
                                     .read_by = kPumpReadBySpeed,
                                     .doc = "speed of the drive; required without an engine"}),
    field<&PumpDef::drive, &PumpDriveParameters::engine>(
        "engine", {.reference = "component", .doc = "engine that drives the pump; absent: the pump has its own speed"}),
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
        {.range = kFraction, .change = Change::live, .doc = "share of the displacement without a control signal"}),
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
    field<&PumpDef::leak_flow>("leak_flow", {.dimension = Dimension::volume_flow,
                                             .range = kNotNegative,
                                             .change = Change::live,
                                             .doc = "leak from outlet to tank at leak_pressure"}),
    field<&PumpDef::leak_pressure>(
        "leak_pressure",
        {.dimension = Dimension::pressure, .range = kPositive, .doc = "pressure difference of leak_flow"}),
};

constexpr double kSwashWidth = 0.01;  // share of the swash, smoothing of its limits

class Pump final : public HydraulicComponent {
 public:
  Pump(const PumpDef& def, CircuitBuilder& builder)
      : HydraulicComponent(def),
        def_(def),
        a_(builder.volume(def.port_a)),
        b_(builder.volume(def.port_b)),
        control_(builder.add_control(def.name, SignalMoves::a_state)),
        alpha_(builder.add_state({.initial = def.swash, .scale = 1})),
        drive_(def.drive, def.displacement, def.mechanical_coefficient, builder) {
    builder.mark_supply(a_);
    apply_parameters();
  }
  // at the command's swash under the start pressures
  void start(double* y) const noexcept override {
    y[alpha_] = limited(def_.swash, y[a_] - y[b_], drive_.at_start(def_.speed)).value;
  }
  void declare_dependencies(DependencyList& dependencies) const override {
    dependencies.add_restriction(a_, b_);
    for (const StateIndex port : {a_, b_}) dependencies.add(port, alpha_), dependencies.add(alpha_, port);
    dependencies.add(alpha_, alpha_);
    drive_.declare_dependencies(a_, b_, alpha_, dependencies);
  }
  void add_rates(const CircuitView& view, Rates& rates) const noexcept override {
    rates.set_rate(alpha_, swash_rate(view, limited(command(view), rise(view), speed(view)).value).value);
    rates.move(b_, a_, flow(view));
    drive_.add_load(view[alpha_], rise(view), rates);
  }
  void add_jacobian(const CircuitView& view, JacobianStamp& jacobian) const noexcept override {
    const Swash least = limited(command(view), rise(view), speed(view));
    const double rate = swash_rate(view, least.value).slope, d_rise = rate * least.over_rise;
    jacobian.add(alpha_, alpha_, -rate);
    jacobian.add(alpha_, a_, d_rise);
    jacobian.add(alpha_, b_, -d_rise);
    jacobian.move(b_, a_, alpha_, per_speed_ * speed(view));
    jacobian.move(b_, a_, a_, -G_leak_);
    jacobian.move(b_, a_, b_, G_leak_);
    drive_.stamp(a_, b_, alpha_, view, per_speed_, jacobian);
    drive_.stamp_speed(alpha_, rate * least.over_speed, jacobian);
  }
  void list_variables(std::vector<ElementVariable>& variables) const override {
    variables.push_back(variable("swash", Dimension::none));
    variables.push_back(variable("flow", Dimension::volume_flow));
    variables.push_back(variable("torque", Dimension::torque));
    variables.push_back(variable("power", Dimension::power));
  }
  double* read_variables(const CircuitView& view, double* values) const noexcept override {
    const double torque = def_.displacement * view[alpha_] * rise(view) / def_.mechanical_coefficient;
    *values++ = view[alpha_];
    *values++ = flow(view);
    *values++ = torque;
    *values++ = torque * speed(view);
    return values;
  }
  [[nodiscard]] void* def_address() noexcept override { return &def_; }
  void apply_parameters() noexcept override {
    per_speed_ = def_.displacement * def_.volumetric_coefficient;
    G_leak_ = def_.leak_flow / def_.leak_pressure;
  }

 private:
  [[nodiscard]] double rise(const CircuitView& view) const noexcept { return view[a_] - view[b_]; }
  // (3)
  [[nodiscard]] double command(const CircuitView& view) const noexcept {
    return std::fmin(std::fmax(def_.swash + def_.swash_per_signal * view.control[control_], 0), 1);
  }
  [[nodiscard]] double speed(const CircuitView& view) const noexcept { return drive_.speed(view, def_.speed); }
  // Rise at which the full swash takes the whole power at the speed n; 0: no limit.
  [[nodiscard]] double full_power_rise(double n) const noexcept {
    const double rate = def_.displacement * n;
    return def_.maximum_power > 0 && rate > 0 ? def_.mechanical_coefficient * def_.maximum_power / rate : 0;
  }
  struct Swash {
    double value, over_rise, over_speed;
  };
  // the least command of (2), with its slopes over the pressure rise p and the speed n
  [[nodiscard]] Swash limited(double command, double p, double n) const noexcept {
    Swash alpha{command, 0, 0};
    if (def_.maximum_pressure > 0) {
      const double gain = def_.controller_gain;
      const ValueSlope u = unit_clip(gain * (def_.maximum_pressure - p), kSwashWidth);
      const ValueSlope least = smooth_min(alpha.value, u.value, kSwashWidth);
      alpha = {least.value, -(1 - least.slope) * u.slope * gain, 0};
    }
    // below half of that rise the limit is far above the full swash
    const double full = full_power_rise(n);
    if (full > 0 && p > 0.5 * full) {
      const double u = full / p;
      const ValueSlope least = smooth_min(alpha.value, u, kSwashWidth);
      alpha = {least.value, least.slope * alpha.over_rise - (1 - least.slope) * u / p, -(1 - least.slope) * u / n};
    }
    return alpha;
  }
  // (2) towards the least command
  [[nodiscard]] ValueSlope swash_rate(const CircuitView& view, double least) const noexcept {
    return servo_rate(least - view[alpha_], def_.time_constant, def_.swash_rate_limit);
  }
  // (1)
  [[nodiscard]] double flow(const CircuitView& view) const noexcept {
    return per_speed_ * speed(view) * view[alpha_] - G_leak_ * rise(view);
  }

  PumpDef def_;
  StateIndex a_, b_;
  int control_;
  StateIndex alpha_;  // swash 0..1
  PumpDrive drive_;
  double per_speed_ = 0, G_leak_ = 0;  // flow per speed at full swash [m3/rad], leak [m3/s/Pa]
};

void validate_plain_pump(const HydraulicsDef& circuit, const ComponentDef& component, Problems& errors, Problems&) {
  const PumpDef& def = static_cast<const PumpDef&>(component);
  check_distinct(def.name + ".port_b", def.port_a, def.port_b, errors);
  check_drive(circuit, def.name, def.drive, def.speed, errors);
}

}  // namespace

void PumpDef::add_lines(PumpLines& lines) const {
  lines.pumps.push_back(
      {.name = name,
       .outlet = port_a,
       .flow = greatest_speed(drive, speed) * displacement * volumetric_coefficient,
       .pressure = maximum_pressure > 0 ? maximum_pressure : std::numeric_limits<double>::infinity()});
}

ComponentType pump_type() {
  return {.name = "pump",
          .fields = kPumpFields,
          .doc = "pump of fixed or variable displacement with limits of pressure and power",
          .make_def = []() -> std::unique_ptr<ComponentDef> { return std::make_unique<PumpDef>(); },
          .validate = validate_plain_pump,
          .build = [](const ComponentDef& def, CircuitBuilder& builder) -> std::unique_ptr<HydraulicComponent> {
            return std::make_unique<Pump>(static_cast<const PumpDef&>(def), builder);
          },
          .has_control_signal = true};
}

}  // namespace slew::hydraulics
