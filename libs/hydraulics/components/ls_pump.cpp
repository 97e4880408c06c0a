// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/components/ls_pump.h"

#include "hydraulics/circuit_builder.h"
#include "hydraulics/component.h"
#include "hydraulics/oil_properties.h"
#include "hydraulics/pump_lines.h"
#include "hydraulics/smooth.h"

namespace slew::hydraulics {
namespace {

constexpr ReadBy kReadByLs[] = {read_by_set<&LsPumpDef::ls_port>("ls_port", "an ls_port")};

constexpr ReadBy kLsPumpReadBySpeed[] = {{"engine", "no engine", [](const void* def) noexcept {
                                            return static_cast<const LsPumpDef*>(def)->drive.engine.empty();
                                          }}};
constexpr ReadBy kLsPumpReadByEngine[] = {{"engine", "an engine", [](const void* def) noexcept {
                                             return !static_cast<const LsPumpDef*>(def)->drive.engine.empty();
                                           }}};

constexpr Field kLsPumpFields[] = {
    field<&LsPumpDef::port_a>("port_a",
                              {.presence = Presence::required, .reference = "volume", .doc = "volume at the outlet"}),
    field<&LsPumpDef::port_b>("port_b",
                              {.presence = Presence::required, .reference = "volume", .doc = "volume of the tank"}),
    field<&LsPumpDef::ls_port>(
        "ls_port", {.reference = "component", .doc = "component whose load-sensing pressure the pump follows"}),
    field<&LsPumpDef::speed>("speed", {.dimension = Dimension::angular_velocity,
                                       .range = kNotNegative,
                                       .change = Change::live,
                                       .read_by = kLsPumpReadBySpeed,
                                       .doc = "speed of the drive; required without an engine"}),
    field<&LsPumpDef::drive, &PumpDriveParameters::engine>(
        "engine", {.reference = "component", .doc = "engine that drives the pump"}),
    field<&LsPumpDef::drive, &PumpDriveParameters::speed_ratio>(
        "speed_ratio",
        {.range = kPositive, .read_by = kLsPumpReadByEngine, .doc = "speed of the pump over that of the engine"}),
    field<&LsPumpDef::displacement>("displacement", {.dimension = Dimension::displacement_volume,
                                                     .range = kPositive,
                                                     .presence = Presence::required,
                                                     .doc = "displacement at full swash"}),
    field<&LsPumpDef::mechanical_coefficient>("mechanical_coefficient",
                                              {.range = kFractionAboveZero, .doc = "hydro-mechanical efficiency"}),
    field<&LsPumpDef::volumetric_coefficient>("volumetric_coefficient",
                                              {.range = kFractionAboveZero, .doc = "volumetric efficiency"}),
    field<&LsPumpDef::controller_gain>(
        "controller_gain",
        {.dimension = Dimension::pressure_gain, .range = kPositive, .doc = "swash per pressure error"}),
    field<&LsPumpDef::time_constant>(
        "time_constant", {.dimension = Dimension::time, .range = kPositive, .doc = "time constant of the swash"}),
    field<&LsPumpDef::set_pressure>("set_pressure", {.dimension = Dimension::pressure,
                                                     .range = kPositive,
                                                     .change = Change::live,
                                                     .read_by = kReadByLs,
                                                     .doc = "margin above the load-sensing pressure"}),
    field<&LsPumpDef::standby_pressure>("standby_pressure", {.dimension = Dimension::pressure,
                                                             .range = kNotNegative,
                                                             .change = Change::live,
                                                             .doc = "outlet pressure without demand, above tank"}),
    field<&LsPumpDef::maximum_ls_pressure>("maximum_ls_pressure",
                                           {.dimension = Dimension::pressure,
                                            .range = kPositive,
                                            .change = Change::live,
                                            .read_by = kReadByLs,
                                            .doc = "limit of the load-sensing pressure, above tank"}),
    field<&LsPumpDef::maximum_torque>("maximum_torque", {.dimension = Dimension::torque,
                                                         .range = kNotNegative,
                                                         .change = Change::live,
                                                         .doc = "torque at which the limiter swings back; 0: none"}),
    field<&LsPumpDef::leak_flow>("leak_flow", {.dimension = Dimension::volume_flow,
                                               .range = kNotNegative,
                                               .change = Change::live,
                                               .doc = "leak from outlet to tank at leak_pressure"}),
    field<&LsPumpDef::leak_pressure>(
        "leak_pressure",
        {.dimension = Dimension::pressure, .range = kPositive, .doc = "pressure difference of the leak flows"}),
};

constexpr double kPumpSwitchWidth = 2e4;  // Pa, smoothing between stand-by and load sensing, and of the LS limit
constexpr double kSwashClipWidth = 0.01;  // share of the swash, smoothing of its limits

class LsPump final : public HydraulicComponent {
 public:
  LsPump(const LsPumpDef& def, CircuitBuilder& builder)
      : HydraulicComponent(def),
        def_(def),
        a_(builder.volume(def.port_a)),
        b_(builder.volume(def.port_b)),
        ls_(def.ls_port.empty() ? -1 : builder.ls_index(def.ls_port)),
        alpha_(builder.add_state({.initial = 0, .scale = 1})),
        drive_(def.drive, def.displacement, def.mechanical_coefficient, def.volumetric_coefficient, builder) {
    builder.mark_supply(a_);
    apply_parameters();
  }
  void declare_dependencies(DependencyList& dependencies) const override {
    dependencies.add_restriction(a_, b_);
    dependencies.add(a_, alpha_), dependencies.add(b_, alpha_);
    dependencies.add(alpha_, alpha_), dependencies.add(alpha_, a_), dependencies.add(alpha_, b_);
    if (ls_ >= 0) dependencies.add_ls(alpha_, ls_);
    drive_.declare_dependencies(a_, b_, alpha_, dependencies);
  }
  void add_rates(const CircuitView& view, Rates& rates) const noexcept override {
    rates.set_rate(alpha_, rate_ * (command(view).value - view[alpha_]));
    rates.move(b_, a_, flow(view));
    drive_.add_load(view[alpha_], view[a_] - view[b_], view, rates);
  }
  void add_jacobian(const CircuitView& view, JacobianStamp& jacobian) const noexcept override {
    const Command u = command(view);
    const double d_command = rate_ * u.over_error * def_.controller_gain, d_rise = d_command - rate_ * u.over_rise;
    jacobian.add(alpha_, alpha_, -rate_);
    jacobian.add(alpha_, a_, -d_rise);
    jacobian.add(alpha_, b_, d_rise);
    if (ls_ >= 0) jacobian.add_ls(alpha_, ls_, d_command * set_point(view).slope);
    const PumpDrive::Displaced displaced = drive_.displaced(view[alpha_], view[a_] - view[b_], view);
    const double G = G_leak_ - full_flow(view) * view[alpha_] * displaced.over_rise;
    jacobian.move(b_, a_, alpha_, full_flow(view) * displaced.value);
    jacobian.move(b_, a_, a_, -G);
    jacobian.move(b_, a_, b_, G);
    drive_.stamp(a_, b_, alpha_, view, per_speed_, jacobian);
  }
  void list_variables(std::vector<ElementVariable>& variables) const override {
    variables.push_back(variable("swash", Dimension::none));
    variables.push_back(variable("flow", Dimension::volume_flow));
    variables.push_back(variable("set_point", Dimension::pressure));
    variables.push_back(variable("torque", Dimension::torque));
    variables.push_back(variable("power", Dimension::power));
  }
  double* read_variables(const CircuitView& view, double* values) const noexcept override {
    const double torque = shaft_torque(view);
    *values++ = view[alpha_];
    *values++ = flow(view);
    *values++ = set_point(view).value;
    *values++ = torque;
    *values++ = torque * drive_.speed(view, def_.speed);
    return values;
  }
  [[nodiscard]] double shaft_power(const CircuitView& view) const noexcept override {
    return shaft_torque(view) * drive_.speed(view, def_.speed);
  }
  void follow_oil(const PortOil& oil) noexcept override {
    fluidity_ = oil.fluidity(a_, b_);
    apply_parameters();
  }
  [[nodiscard]] void* def_address() noexcept override { return &def_; }
  void apply_parameters() noexcept override {
    per_speed_ = def_.displacement * def_.volumetric_coefficient;
    full_flow_ = def_.displacement * def_.speed * def_.volumetric_coefficient;
    G_leak_ = fluidity_ * def_.leak_flow / def_.leak_pressure;
    rate_ = 1 / def_.time_constant;
    full_torque_rise_ = def_.mechanical_coefficient * def_.maximum_torque / def_.displacement;
  }

 private:
  [[nodiscard]] double shaft_torque(const CircuitView& view) const noexcept {
    return drive_.torque(view[alpha_], view[a_] - view[b_], view);
  }
  // set pressure of the controller at the outlet, above tank; slope with respect to the LS pressure
  [[nodiscard]] ValueSlope set_point(const CircuitView& view) const noexcept {
    if (ls_ < 0) return {def_.standby_pressure, 0};
    const ValueSlope limited = smooth_min(view.ls[ls_], def_.maximum_ls_pressure, kPumpSwitchWidth);
    const ValueSlope set = smooth_max(limited.value + def_.set_pressure, def_.standby_pressure, kPumpSwitchWidth);
    return {set.value, set.slope * limited.slope};
  }
  struct Command {
    double value;
    double over_error;     // slope with respect to K (p_set - rise)
    double over_rise = 0;  // slope of the torque limiter over the rise [1/Pa]
  };
  // swash command
  [[nodiscard]] Command command(const CircuitView& view) const noexcept {
    const double rise = view[a_] - view[b_];
    const ValueSlope u = unit_clip(def_.controller_gain * (set_point(view).value - rise), kSwashClipWidth);
    // below half of the rise at which the full swash takes the torque the limit is far above the full swash
    if (!(full_torque_rise_ > 0) || rise <= 0.5 * full_torque_rise_) return {u.value, u.slope};
    const double limit = full_torque_rise_ / rise;
    const ValueSlope least = smooth_min(u.value, limit, kSwashClipWidth);
    return {least.value, least.slope * u.slope, -(1 - least.slope) * limit / rise};
  }
  [[nodiscard]] double flow(const CircuitView& view) const noexcept {
    const double p = view[a_] - view[b_];
    return full_flow(view) * view[alpha_] * drive_.displaced(view[alpha_], p, view).value - G_leak_ * p;
  }
  [[nodiscard]] double full_flow(const CircuitView& view) const noexcept {
    return drive_.has_engine() ? per_speed_ * drive_.speed(view, 0) : full_flow_;
  }

  LsPumpDef def_;
  StateIndex a_, b_;
  LsIndex ls_;        // -1: none
  StateIndex alpha_;  // swash 0..1
  PumpDrive drive_;
  double per_speed_ = 0;  // m3/rad, flow per speed at full swash
  double full_flow_ = 0, G_leak_ = 0, rate_ = 0;
  double fluidity_ = 1;          // of the oil, for leaks
  double full_torque_rise_ = 0;  // Pa, at which the full swash takes maximum_torque; 0: no limiter
};

void validate_pump(const HydraulicsDef& circuit, const ComponentDef& component, Problems& errors, Problems&) {
  const LsPumpDef& def = static_cast<const LsPumpDef&>(component);
  check_drive(circuit, def.name, def.drive, def.speed, errors);
  for (const VolumeDef& volume : circuit.volumes) {
    if (volume.name != def.port_b || volume.fixed) continue;
    errors.push_back({def.name + ".port_b",
                      "the pump has no tank: '" + def.port_b + "' is not held at a fixed pressure",
                      "a volume with fixed: true", ""});
  }
}

}  // namespace

void LsPumpDef::add_lines(PumpLines& lines) const {
  lines.supply.insert(port_a);
  lines.pumps.push_back({.name = name,
                         .outlet = port_a,
                         .inlet = port_b,
                         .flow = greatest_speed(drive, speed) * displacement * volumetric_coefficient,
                         .pressure = ls_port.empty() ? standby_pressure
                                                     : std::max(standby_pressure, maximum_ls_pressure + set_pressure)});
}

ComponentType ls_pump_type() {
  return {.name = "ls_pump",
          .fields = kLsPumpFields,
          .doc = "variable-displacement pump with load-sensing controller",
          .make_def = []() -> std::unique_ptr<ComponentDef> { return std::make_unique<LsPumpDef>(); },
          .validate = validate_pump,
          .build = [](const ComponentDef& def, CircuitBuilder& builder) -> std::unique_ptr<HydraulicComponent> {
            return std::make_unique<LsPump>(static_cast<const LsPumpDef&>(def), builder);
          }};
}

}  // namespace slew::hydraulics
