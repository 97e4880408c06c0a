// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/components/accumulator.h"

#include <cmath>

#include "core/step_report.h"
#include "hydraulics/circuit_builder.h"
#include "hydraulics/component.h"
#include "hydraulics/passages.h"
#include "hydraulics/pump_lines.h"
#include "hydraulics/smooth.h"

namespace slew::hydraulics {
namespace {

constexpr Field kAccumulatorFields[] = {
    field<&AccumulatorDef::port_1>(
        "port_1", {.presence = Presence::required, .reference = "volume", .doc = "volume at the port"}),
    field<&AccumulatorDef::gas_volume>("gas_volume", {.dimension = Dimension::volume,
                                                      .range = kPositive,
                                                      .presence = Presence::required,
                                                      .doc = "volume of the gas at precharge_pressure"}),
    field<&AccumulatorDef::precharge_pressure>("precharge_pressure",
                                               {.dimension = Dimension::pressure,
                                                .range = kPositive,
                                                .presence = Presence::required,
                                                .change = Change::live,
                                                .doc = "absolute pressure of the gas without oil"}),
    field<&AccumulatorDef::polytropic_exponent>(
        "polytropic_exponent",
        {.range = kPolytropicRange, .doc = "polytropic exponent; the adiabatic one with a thermal_time_constant"}),
    field<&AccumulatorDef::thermal_time_constant>(
        "thermal_time_constant", {.dimension = Dimension::time,
                                  .range = kNotNegative,
                                  .doc = "time constant of the heat exchange with the walls; 0: polytropic gas"}),
    field<&AccumulatorDef::friction_pressure>("friction_pressure",
                                              {.dimension = Dimension::pressure,
                                               .range = kNotNegative,
                                               .change = Change::live,
                                               .doc = "pressure difference that moves a piston's seals"}),
    field<&AccumulatorDef::nominal_flow>("nominal_flow",
                                         {.dimension = Dimension::volume_flow,
                                          .range = kPositive,
                                          .presence = Presence::required,
                                          .change = Change::live,
                                          .doc = "flow through the connection at nominal_pressure_drop"}),
    field<&AccumulatorDef::nominal_pressure_drop>(
        "nominal_pressure_drop",
        {.dimension = Dimension::pressure, .range = kPositive, .doc = "pressure drop of nominal_flow"}),
};

constexpr double kSmallestGasVolume = 1e-3;  // nu, below which (2) goes on along its tangent, so that it stays defined
constexpr double kClosing = 0.01;            // f, below which the oil valve closes
constexpr double kClosingClipWidth = 0.02;   // share of the closing, smoothing of its limits
constexpr double kFrictionWidth = 0.1;       // share of the friction pressure, smoothing of its edges

class Accumulator final : public HydraulicComponent {
 public:
  Accumulator(const AccumulatorDef& def, CircuitBuilder& builder)
      : HydraulicComponent(def),
        def_(def),
        p_(builder.volume(def.port_1)),
        f_(builder.add_state({.initial = 0, .scale = 1})),
        z_(def.thermal_time_constant > 0 ? builder.add_state({.initial = 1, .scale = 1}) : -1),
        transition_(builder.def().orifice_transition) {
    apply_parameters();
  }
  // filled slowly, at rest at the pressure of its volume
  void start(double* y) const noexcept override {
    const double ratio = std::fmin(def_.precharge_pressure / y[p_], 1);
    const double nu = z_ < 0 ? std::pow(ratio, 1 / def_.polytropic_exponent) : ratio;
    y[f_] = 1 - nu;
    if (z_ >= 0) y[z_] = std::pow(nu, def_.polytropic_exponent - 1);
  }
  void declare_dependencies(DependencyList& dependencies) const override {
    dependencies.add_restriction(p_, f_);
    if (z_ < 0) return;
    dependencies.add(p_, z_), dependencies.add(f_, z_), dependencies.add(z_, z_), dependencies.add(z_, f_);
  }
  void add_rates(const CircuitView& view, Rates& rates) const noexcept override {
    const double Q = flow(view).value;
    rates.add_flow(p_, -Q);
    rates.set_rate(f_, Q / def_.gas_volume);
    if (z_ >= 0) rates.set_rate(z_, (isothermal_z(view).value - view[z_]) / def_.thermal_time_constant);
  }
  void add_jacobian(const CircuitView& view, JacobianStamp& jacobian) const noexcept override {
    const Flow Q = flow(view);
    const double per_volume = 1 / def_.gas_volume;
    jacobian.add(p_, p_, -Q.d_p), jacobian.add(f_, p_, per_volume * Q.d_p);
    jacobian.add(p_, f_, -Q.d_f), jacobian.add(f_, f_, per_volume * Q.d_f);
    if (z_ < 0) return;
    jacobian.add(p_, z_, -Q.d_z), jacobian.add(f_, z_, per_volume * Q.d_z);
    jacobian.add(z_, z_, -1 / def_.thermal_time_constant);
    jacobian.add(z_, f_, isothermal_z(view).slope / def_.thermal_time_constant);
  }
  // an empty accumulator: at the gas pressure the partner gets the slope of oil that enters
  void raise_slopes(const CircuitView& view, JacobianStamp& slopes) const noexcept override {
    if (std::fabs(view[p_] - gas(view).p) > transition_ + def_.friction_pressure) return;
    const double rise = std::fmax(0, K_ * root(0, transition_).slope - flow(view).d_p);
    const double by_f = -rise * gas(view).d_f, per_volume = 1 / def_.gas_volume;
    slopes.add(p_, p_, -rise), slopes.add(f_, p_, per_volume * rise);
    slopes.add(p_, f_, -by_f), slopes.add(f_, f_, per_volume * by_f);
  }
  [[nodiscard]] std::uint32_t flags(const CircuitView& view) const noexcept override {
    return 1 - view[f_] < kSmallestGasVolume ? static_cast<std::uint32_t>(StepFlag::clamp_active) : 0;
  }
  void list_variables(std::vector<ElementVariable>& variables) const override {
    variables.push_back(variable("oil_volume", Dimension::volume));
    variables.push_back(variable("gas_pressure", Dimension::pressure));
    variables.push_back(variable("temperature_ratio", Dimension::none));
    variables.push_back(variable("flow", Dimension::volume_flow));
  }
  double* read_variables(const CircuitView& view, double* values) const noexcept override {
    const double nu = std::fmax(1 - view[f_], kSmallestGasVolume);
    *values++ = view[f_] * def_.gas_volume;
    *values++ = gas(view).p;
    *values++ = (z_ < 0 ? 1 : view[z_]) * std::pow(nu, 1 - def_.polytropic_exponent);
    *values++ = flow(view).value;
    return values;
  }
  // the drop at the inlet heats the oil of the volume
  void add_passages(const CircuitView& view, Passages& passages) const noexcept override {
    passages.add_content(p_, view[f_] * def_.gas_volume);
    passages.add_heat(p_, flow(view).value * (view[p_] - gas(view).p));
  }
  [[nodiscard]] void* def_address() noexcept override { return &def_; }
  void apply_parameters() noexcept override { K_ = def_.nominal_flow / std::sqrt(def_.nominal_pressure_drop); }

 private:
  struct Gas {
    double p, d_f, d_z;  // Pa, and slopes over f and z
  };
  struct Flow {
    double value, d_p, d_f, d_z;  // m3/s, and slopes over p, f and z
  };
  // (2)
  [[nodiscard]] Gas gas(const CircuitView& view) const noexcept {
    const double n = def_.polytropic_exponent, nu = 1 - view[f_];
    const double bounded = std::fmax(nu, kSmallestGasVolume);
    double law = def_.precharge_pressure * std::pow(bounded, -n);
    const double slope = n * law / bounded;
    if (nu < kSmallestGasVolume) law += slope * (kSmallestGasVolume - nu);
    const double z = z_ < 0 ? 1 : view[z_];
    return {z * law, z * slope, law};
  }
  // nu^(n - 1) with its slope over f
  [[nodiscard]] ValueSlope isothermal_z(const CircuitView& view) const noexcept {
    const double n = def_.polytropic_exponent, nu = 1 - view[f_];
    if (nu < kSmallestGasVolume) return {std::pow(kSmallestGasVolume, n - 1), 0};
    const double value = std::pow(nu, n - 1);
    return {value, -(n - 1) * value / nu};
  }
  // the difference beyond the friction of the seals
  [[nodiscard]] ValueSlope band(double d) const noexcept {
    const double friction = def_.friction_pressure;
    if (friction == 0) return {d, 1};
    const ValueSlope in = ramp(d - friction, kFrictionWidth * friction);
    const ValueSlope out = ramp(-d - friction, kFrictionWidth * friction);
    return {in.value - out.value, in.slope + out.slope};
  }
  // (4)
  [[nodiscard]] Flow flow(const CircuitView& view) const noexcept {
    const Gas g = gas(view);
    const ValueSlope d = band(view[p_] - g.p), r = root(d.value, transition_);
    ValueSlope e{1, 0};
    if (d.value < 0) e = unit_clip(view[f_] / kClosing, kClosingClipWidth);
    const double d_p = e.value * K_ * r.slope * d.slope;
    return {e.value * K_ * r.value, d_p, e.slope / kClosing * K_ * r.value - d_p * g.d_f, -d_p * g.d_z};
  }

  AccumulatorDef def_;
  StateIndex p_;
  StateIndex f_;  // oil over gas_volume
  StateIndex z_;  // -1: none
  double transition_;
  double K_ = 0;
};

}  // namespace

void AccumulatorDef::add_lines(PumpLines& lines) const {
  lines.accumulators.push_back({name, port_1, precharge_pressure});
}

ComponentType accumulator_type() {
  return {.name = "accumulator",
          .fields = kAccumulatorFields,
          .doc = "gas accumulator: bladder, diaphragm or piston",
          .make_def = []() -> std::unique_ptr<ComponentDef> { return std::make_unique<AccumulatorDef>(); },
          .validate = nullptr,
          .build = [](const ComponentDef& def, CircuitBuilder& builder) -> std::unique_ptr<HydraulicComponent> {
            return std::make_unique<Accumulator>(static_cast<const AccumulatorDef&>(def), builder);
          }};
}

}  // namespace slew::hydraulics
