// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/components/relief_valve.h"

#include <cmath>
#include "hydraulics/circuit_builder.h"
#include "hydraulics/component.h"
#include "hydraulics/oil.h"
#include "hydraulics/pump_lines.h"
#include "hydraulics/smooth.h"

namespace slew::hydraulics {
namespace {

constexpr auto kReliefValveFields = with_proportional<ReliefValveDef>(std::array{
    field<&ReliefValveDef::port_1>(
        "port_1", {.presence = Presence::required, .reference = "volume", .doc = "volume at the inlet"}),
    field<&ReliefValveDef::port_2>("port_2", {.presence = Presence::required,
                                              .reference = "volume",
                                              .doc = "volume at the outlet, which the setting is relative to"}),
    field<&ReliefValveDef::port_3>("port_3",
                                   {.reference = "volume", .doc = "volume that pilots the valve, without it port_1"}),
    field<&ReliefValveDef::nominal_flow>("nominal_flow", {.dimension = Dimension::volume_flow,
                                                          .range = kPositive,
                                                          .presence = Presence::required,
                                                          .change = Change::live,
                                                          .doc = "flow of the open valve at nominal_pressure_drop"}),
    field<&ReliefValveDef::nominal_pressure_drop>(
        "nominal_pressure_drop",
        {.dimension = Dimension::pressure, .range = kPositive, .doc = "pressure drop of nominal_flow"}),
    field<&ReliefValveDef::setting_pressure>("setting_pressure", {.dimension = Dimension::pressure,
                                                                  .range = kPositive,
                                                                  .presence = Presence::required,
                                                                  .change = Change::live,
                                                                  .doc = "crack pressure above the outlet"}),
    field<&ReliefValveDef::opening_pressure_rise>("opening_pressure_rise",
                                                  {.dimension = Dimension::pressure,
                                                   .range = kPositive,
                                                   .doc = "rise above the setting that opens the valve fully"}),
    field<&ReliefValveDef::step_response>(
        "step_response",
        {.dimension = Dimension::time, .range = kPositive, .doc = "three time constants of the opening"}),
});

constexpr double kOpeningClipWidth = 0.02;  // share of the opening, smoothing of its limits
constexpr double kOpenPilot = 1e-3;         // opening above which the valve counts as open
constexpr double kPilotTimeConstants = 3;   // in a step response, to 95 % of the change

class ReliefValve final : public HydraulicComponent {
 public:
  ReliefValve(const ReliefValveDef& def, CircuitBuilder& builder)
      : HydraulicComponent(def),
        def_(def),
        p_1_(builder.volume(def.port_1)),
        p_2_(builder.volume(def.port_2)),
        pilot_(builder.volume(def.port_3.empty() ? def.port_1 : def.port_3)),
        u_(builder.add_state({.initial = 0, .scale = 1})),
        setting_(def, builder),
        transition_(builder.def().orifice_transition) {
    apply_parameters();
    if (pilot_ != p_1_) return;
    builder.add_relief({.valve = def.name,
                        .volume = p_1_,
                        .outlet = p_2_,
                        .fully_open = def.setting_pressure + def.opening_pressure_rise});
  }
  // at the opening that the start pressures command
  void start(double* y) const noexcept override { y[u_] = opening_command({y, nullptr, nullptr, nullptr}).value; }
  void declare_dependencies(DependencyList& dependencies) const override {
    dependencies.add_restriction(p_1_, p_2_);
    dependencies.add(p_1_, u_), dependencies.add(p_2_, u_);
    dependencies.add(u_, u_), dependencies.add(u_, pilot_), dependencies.add(u_, p_2_);
    setting_.declare(dependencies);
    if (setting_.is_used()) dependencies.add(u_, setting_.state());
  }
  void add_rates(const CircuitView& view, Rates& rates) const noexcept override {
    rates.set_rate(u_, rate_ * (opening_command(view).value - view[u_]));
    setting_.add_rate(view, def_.solenoid, rates);
    rates.move(p_1_, p_2_, flow(view));
  }
  void add_jacobian(const CircuitView& view, JacobianStamp& jacobian) const noexcept override {
    const double d_command = rate_ * opening_command(view).slope * per_pressure_;
    jacobian.add(u_, u_, -rate_);
    jacobian.add(u_, pilot_, d_command);
    jacobian.add(u_, p_2_, -d_command);
    setting_.stamp_rate(def_.solenoid, jacobian);
    if (setting_.is_used()) jacobian.add(u_, setting_.state(), -d_command * set_pressure(view).slope);
    const ValueSlope r = root(view[p_1_] - view[p_2_], transition_);
    jacobian.move(p_1_, p_2_, u_, K_ * r.value);
    jacobian.move(p_1_, p_2_, p_1_, view[u_] * K_ * r.slope);
    jacobian.move(p_1_, p_2_, p_2_, -view[u_] * K_ * r.slope);
  }
  [[nodiscard]] std::uint32_t flags(const CircuitView& view) const noexcept override {
    return view[u_] > kOpenPilot ? static_cast<std::uint32_t>(StepFlag::relief_open) : 0;
  }
  void list_variables(std::vector<ElementVariable>& variables) const override {
    variables.push_back(variable("opening", Dimension::none));
    variables.push_back(variable("flow", Dimension::volume_flow));
    variables.push_back(variable("is_open", Dimension::none));
    if (setting_.is_used()) variables.push_back(variable("set_pressure", Dimension::pressure));
  }
  double* read_variables(const CircuitView& view, double* values) const noexcept override {
    *values++ = view[u_];
    *values++ = flow(view);
    *values++ = view[u_] > kOpenPilot ? 1 : 0;
    if (setting_.is_used()) *values++ = set_pressure(view).value;
    return values;
  }
  [[nodiscard]] void* def_address() noexcept override { return &def_; }
  void apply_parameters() noexcept override {
    K_ = def_.nominal_flow / std::sqrt(def_.nominal_pressure_drop);
    per_pressure_ = 1 / def_.opening_pressure_rise;
    rate_ = kPilotTimeConstants / def_.step_response;
  }

 private:
  [[nodiscard]] ValueSlope set_pressure(const CircuitView& view) const noexcept {
    return setting_.pressure(view, def_.solenoid, def_.setting_pressure);
  }
  [[nodiscard]] ValueSlope opening_command(const CircuitView& view) const noexcept {
    return unit_clip((view[pilot_] - view[p_2_] - set_pressure(view).value) * per_pressure_, kOpeningClipWidth);
  }
  [[nodiscard]] double flow(const CircuitView& view) const noexcept {
    if (view[u_] == 0) return 0;
    return view[u_] * K_ * root(view[p_1_] - view[p_2_], transition_).value;
  }

  ReliefValveDef def_;
  StateIndex p_1_, p_2_, pilot_;
  StateIndex u_;  // opening 0..1
  ProportionalSetting setting_;
  double transition_;
  double K_ = 0, per_pressure_ = 0, rate_ = 0;
};

void validate_relief_valve(const HydraulicsDef&, const ComponentDef& component, Problems& errors, Problems&) {
  const ReliefValveDef& def = static_cast<const ReliefValveDef&>(component);
  check_minimum_pressure(def, def.setting_pressure, "setting_pressure", errors);
}

}  // namespace

void ReliefValveDef::add_lines(PumpLines& lines) const {
  if (port_3.empty() || port_3 == port_1) lines.limits.push_back({name, port_1, port_2, setting_pressure});
  if (!(setting_pressure < OilCompressibility::kHighest)) return;
  const double most = nominal_flow * std::sqrt(OilCompressibility::kHighest / nominal_pressure_drop);
  lines.open.push_back({.a = port_1, .b = port_2, .flow = most, .is_one_way = true, .pilot = port_3});
}

ComponentType relief_valve_type() {
  return {.name = "relief_valve",
          .fields = kReliefValveFields,
          .doc = "pilot-operated pressure relief valve, at a setting or by a control signal",
          .make_def = []() -> std::unique_ptr<ComponentDef> { return std::make_unique<ReliefValveDef>(); },
          .validate = validate_relief_valve,
          .build = [](const ComponentDef& def, CircuitBuilder& builder) -> std::unique_ptr<HydraulicComponent> {
            return std::make_unique<ReliefValve>(static_cast<const ReliefValveDef&>(def), builder);
          },
          .has_control_signal = true};
}

}  // namespace slew::hydraulics
