// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/components/flow_divider.h"

#include <cmath>

#include "hydraulics/circuit_builder.h"
#include "hydraulics/component.h"
#include "hydraulics/components/shared_fields.h"
#include "hydraulics/components/spring_spool.h"
#include "hydraulics/oil.h"
#include "hydraulics/oil_properties.h"
#include "hydraulics/pump_lines.h"
#include "hydraulics/smooth.h"

namespace slew::hydraulics {
namespace {

constexpr Range kShareRange{.min = 0, .max = 1};

constexpr Field kFlowDividerFields[] = {
    field<&FlowDividerDef::port_1>("port_1", port_options("volume at the common port")),
    field<&FlowDividerDef::port_2>("port_2", port_options("volume of the branch with `share`")),
    field<&FlowDividerDef::port_3>("port_3", port_options("volume of the other branch")),
    field<&FlowDividerDef::nominal_flow>("nominal_flow",
                                         nominal_flow_options("flow of the common port at both pressure drops")),
    field<&FlowDividerDef::metering_pressure_drop>("metering_pressure_drop",
                                                   {.dimension = Dimension::pressure,
                                                    .range = kPositive,
                                                    .doc = "drop over the metering orifices at nominal_flow"}),
    field<&FlowDividerDef::spool_pressure_drop>(
        "spool_pressure_drop",
        {.dimension = Dimension::pressure, .range = kPositive, .doc = "drop over the open spool at nominal_flow"}),
    field<&FlowDividerDef::share>("share", {.range = kShareRange, .doc = "share of port_2 in the flow"}),
    field<&FlowDividerDef::regulation_pressure>(
        "regulation_pressure", {.dimension = Dimension::pressure,
                                .range = kPositive,
                                .doc = "difference of the metering drops that throttles a branch most"}),
    field<&FlowDividerDef::least_opening>(
        "least_opening", {.range = kShareRange, .change = Change::live, .doc = "opening of a throttled branch"}),
    field<&FlowDividerDef::step_response>("step_response",
                                          step_response_options("three time constants of the opening")),
};

constexpr Field kGearFlowDividerFields[] = {
    field<&GearFlowDividerDef::port_1>("port_1", port_options("volume at the common port")),
    field<&GearFlowDividerDef::port_2>("port_2", port_options("volume of one branch")),
    field<&GearFlowDividerDef::port_3>("port_3", port_options("volume of the other branch")),
    field<&GearFlowDividerDef::displacement_2>("displacement_2", {.dimension = Dimension::displacement_volume,
                                                                  .range = kPositive,
                                                                  .presence = Presence::required,
                                                                  .doc = "displacement of the unit at port_2"}),
    field<&GearFlowDividerDef::displacement_3>("displacement_3", {.dimension = Dimension::displacement_volume,
                                                                  .range = kPositive,
                                                                  .presence = Presence::required,
                                                                  .doc = "displacement of the unit at port_3"}),
    field<&GearFlowDividerDef::inertia>(
        "inertia", {.dimension = Dimension::inertia, .range = kPositive, .doc = "inertia of the gears on the shaft"}),
    field<&GearFlowDividerDef::friction_pressure>("friction_pressure",
                                                  {.dimension = Dimension::pressure,
                                                   .range = kNotNegative,
                                                   .change = Change::live,
                                                   .doc = "drop at which it turns without a load"}),
    field<&GearFlowDividerDef::friction_speed>(
        "friction_speed",
        {.dimension = Dimension::angular_velocity, .range = kPositive, .doc = "speed over which friction builds up"}),
    field<&GearFlowDividerDef::leak_flow>("leak_flow", {.dimension = Dimension::volume_flow,
                                                        .range = kNotNegative,
                                                        .change = Change::live,
                                                        .doc = "leak of each unit at leak_pressure"}),
    field<&GearFlowDividerDef::leak_pressure>(
        "leak_pressure",
        {.dimension = Dimension::pressure, .range = kPositive, .doc = "pressure difference of the leak flows"}),
};

constexpr double kDividerCentreWidth = 1e-3;  // share of the travel, smoothing where an edge begins to shut
constexpr double kSignFlow = 0.02;            // share of nominal_flow, over which the sign of the flow changes

class FlowDivider final : public HydraulicComponent {
 public:
  FlowDivider(const FlowDividerDef& def, CircuitBuilder& builder)
      : HydraulicComponent(def),
        def_(def),
        p_1_(builder.volume(def.port_1)),
        branches_{builder.volume(def.port_2), builder.volume(def.port_3)},
        y_(builder.add_state({.initial = 0, .scale = 1})),
        spool_(y_, builder.def().orifice_transition),
        transition_(builder.def().orifice_transition) {
    apply_parameters();
  }
  void declare_dependencies(DependencyList& dependencies) const override {
    for (const StateIndex branch : branches_) {
      dependencies.add_restriction(p_1_, branch);
      dependencies.add(branch, y_), dependencies.add(y_, branch);
    }
    dependencies.add(p_1_, y_), dependencies.add(y_, p_1_), dependencies.add(y_, y_);
  }
  void add_rates(const CircuitView& view, Rates& rates) const noexcept override {
    const Branch branch[2] = {flow(view, 0), flow(view, 1)};
    spool_.add_rate(view, command(branch).value, rates);
    for (int i : {0, 1}) rates.move(p_1_, branches_[i], branch[i].Q.value);
  }
  void add_jacobian(const CircuitView& view, JacobianStamp& jacobian) const noexcept override {
    const Branch branch[2] = {flow(view, 0), flow(view, 1)};
    const Command x = command(branch);
    jacobian.add(y_, y_, -spool_.rate());
    for (int i : {0, 1}) {
      const auto& [Q, d] = branch[i];
      spool_.stamp_edge(p_1_, branches_[i], Q, jacobian);
      const double over_drop = spool_.rate() * (x.over_flow * Q.over_drop + x.over_d[i] * d.over_drop);
      jacobian.add(y_, p_1_, over_drop);
      jacobian.add(y_, branches_[i], -over_drop);
      jacobian.add(y_, y_, spool_.rate() * (x.over_flow * Q.over_position + x.over_d[i] * d.over_position));
    }
  }
  void list_variables(std::vector<ElementVariable>& variables) const override {
    variables.push_back(variable("spool_position", Dimension::none));
    variables.push_back(variable("flow_2", Dimension::volume_flow));
    variables.push_back(variable("flow_3", Dimension::volume_flow));
  }
  double* read_variables(const CircuitView& view, double* values) const noexcept override {
    *values++ = view[y_];
    for (int i : {0, 1}) *values++ = flow(view, i).Q.value;
    return values;
  }
  [[nodiscard]] void* def_address() noexcept override { return &def_; }
  void apply_parameters() noexcept override {
    spool_.set(def_.nominal_flow, def_.metering_pressure_drop, def_.step_response);
    K_[0] = def_.share * spool_.K(), K_[1] = (1 - def_.share) * spool_.K();
    k_2_ = def_.spool_pressure_drop / def_.metering_pressure_drop;
  }

 private:
  // Flow of a branch, and the drop over its metering orifice [Pa], with their slopes.
  struct Branch {
    EdgeFlow Q, d;
  };
  // (1), (2) and d_i of (3); i: 0 branch 2, 1 branch 3
  [[nodiscard]] Branch flow(const CircuitView& view, int i) const noexcept {
    const double side = i == 0 ? 1 : -1, drop = view[p_1_] - view[branches_[i]];
    const ValueSlope shut = ramp(side * view[y_], kDividerCentreWidth), r = root(drop, transition_);
    const double w = 1 - (1 - def_.least_opening) * shut.value, q = w * w + k_2_, open = w / std::sqrt(q);
    const double w_over_y = -(1 - def_.least_opening) * shut.slope * side;
    const double open_over_y = w_over_y * k_2_ / (q * std::sqrt(q));
    return {{open * K_[i] * r.value, open * K_[i] * r.slope, open_over_y * K_[i] * r.value},
            {open * open * drop, open * open, 2 * open * open_over_y * drop}};
  }
  struct Command {
    double value, over_flow, over_d[2];
  };
  // command of (3), with its slopes over T and d_i
  [[nodiscard]] Command command(const Branch (&branch)[2]) const noexcept {
    const double T = branch[0].Q.value + branch[1].Q.value, T_s = kSignFlow * def_.nominal_flow;
    const double q = T * T + T_s * T_s, sign = T / std::sqrt(q), d_sign = T_s * T_s / (q * std::sqrt(q));
    const double difference = branch[0].d.value - branch[1].d.value;
    const double x = sign * difference / def_.regulation_pressure;
    const ValueSlope twice = unit_clip(0.5 * (x + 1), 0.5 * SpringSpool::kEndWidth);
    const double slope = twice.slope / def_.regulation_pressure;
    return {2 * twice.value - 1, slope * d_sign * difference, {slope * sign, -slope * sign}};
  }

  FlowDividerDef def_;
  StateIndex p_1_, branches_[2];
  StateIndex y_;  // -1..1; positive throttles branch 2
  SpringSpool spool_;
  double transition_;
  double K_[2] = {};
  double k_2_ = 0;
};

class GearFlowDivider final : public HydraulicComponent {
 public:
  GearFlowDivider(const GearFlowDividerDef& def, CircuitBuilder& builder)
      : HydraulicComponent(def),
        def_(def),
        p_1_(builder.volume(def.port_1)),
        branches_{builder.volume(def.port_2), builder.volume(def.port_3)},
        w_(builder.add_state({.initial = 0, .scale = 1})),
        D_{def.displacement_2, def.displacement_3} {
    apply_parameters();
  }
  void declare_dependencies(DependencyList& dependencies) const override {
    for (const StateIndex branch : branches_) {
      dependencies.add_restriction(p_1_, branch);
      dependencies.add(branch, w_), dependencies.add(w_, branch);
    }
    dependencies.add(p_1_, w_), dependencies.add(w_, p_1_), dependencies.add(w_, w_);
  }
  void add_rates(const CircuitView& view, Rates& rates) const noexcept override {
    double torque = -friction(view).value;
    for (int i : {0, 1}) {
      torque += D_[i] * (view[p_1_] - view[branches_[i]]);
      rates.move(p_1_, branches_[i], flow(view, i));
    }
    rates.set_rate(w_, torque / def_.inertia);
  }
  void add_jacobian(const CircuitView& view, JacobianStamp& jacobian) const noexcept override {
    jacobian.add(w_, w_, -friction(view).slope / def_.inertia);
    for (int i : {0, 1}) {
      jacobian.move(p_1_, branches_[i], p_1_, G_);
      jacobian.move(p_1_, branches_[i], branches_[i], -G_);
      jacobian.move(p_1_, branches_[i], w_, D_[i]);
      jacobian.add(w_, p_1_, D_[i] / def_.inertia);
      jacobian.add(w_, branches_[i], -D_[i] / def_.inertia);
    }
  }
  void list_variables(std::vector<ElementVariable>& variables) const override {
    variables.push_back(variable("speed", Dimension::angular_velocity));
    variables.push_back(variable("flow_2", Dimension::volume_flow));
    variables.push_back(variable("flow_3", Dimension::volume_flow));
  }
  double* read_variables(const CircuitView& view, double* values) const noexcept override {
    *values++ = view[w_];
    for (int i : {0, 1}) *values++ = flow(view, i);
    return values;
  }
  void follow_oil(const PortOil& oil) noexcept override {
    fluidity_ = oil.fluidity(p_1_, branches_[0]);
    apply_parameters();
  }
  [[nodiscard]] void* def_address() noexcept override { return &def_; }
  void apply_parameters() noexcept override {
    G_ = fluidity_ * def_.leak_flow / def_.leak_pressure;
    T_f_ = (D_[0] + D_[1]) * def_.friction_pressure;
  }

 private:
  // (4)
  [[nodiscard]] double flow(const CircuitView& view, int i) const noexcept {
    return D_[i] * view[w_] + G_ * (view[p_1_] - view[branches_[i]]);
  }
  // last term of (5)
  [[nodiscard]] ValueSlope friction(const CircuitView& view) const noexcept {
    const double w = view[w_], q = w * w + def_.friction_speed * def_.friction_speed, s = std::sqrt(q);
    return {T_f_ * w / s, T_f_ * def_.friction_speed * def_.friction_speed / (q * s)};
  }

  GearFlowDividerDef def_;
  StateIndex p_1_, branches_[2];
  StateIndex w_;  // rad/s
  double D_[2];
  double G_ = 0, T_f_ = 0;
  double fluidity_ = 1;  // of the oil, for leaks
};

template <typename Def>
void validate_divider(const HydraulicsDef&, const ComponentDef& component, Problems& errors, Problems&) {
  const Def& def = static_cast<const Def&>(component);
  check_three_ports(def, errors);
}

template <typename Def, typename Component>
ComponentType divider_type(std::string_view name, std::span<const Field> fields, std::string_view doc) {
  return {.name = name,
          .fields = fields,
          .doc = doc,
          .make_def = []() -> std::unique_ptr<ComponentDef> { return std::make_unique<Def>(); },
          .validate = validate_divider<Def>,
          .build = [](const ComponentDef& def, CircuitBuilder& builder) -> std::unique_ptr<HydraulicComponent> {
            return std::make_unique<Component>(static_cast<const Def&>(def), builder);
          }};
}

template <typename Def>
void add_divider_lines(const Def& def, PumpLines& lines) {
  lines.dividers.push_back({.common = def.port_1, .branch_2 = def.port_2, .branch_3 = def.port_3});
  for (const std::string* branch : {&def.port_2, &def.port_3}) {
    lines.open.push_back({.a = *branch, .b = def.port_1, .is_one_way = true});
  }
}

}  // namespace

// a branch that stands still leaves the other one its least opening
void FlowDividerDef::add_lines(PumpLines& lines) const {
  add_divider_lines(*this, lines);
  const double k_2 = spool_pressure_drop / metering_pressure_drop;
  const double most = nominal_flow * std::sqrt(OilCompressibility::kHighest / metering_pressure_drop) * least_opening /
                      std::sqrt(least_opening * least_opening + k_2);
  lines.open.push_back({.a = port_1, .b = port_2, .flow = share * most, .is_one_way = true});
  lines.open.push_back({.a = port_1, .b = port_3, .flow = (1 - share) * most, .is_one_way = true});
}
// a branch that stands still stops the shaft
void GearFlowDividerDef::add_lines(PumpLines& lines) const {
  add_divider_lines(*this, lines);
}

ComponentType flow_divider_type() {
  return divider_type<FlowDividerDef, FlowDivider>("flow_divider", kFlowDividerFields,
                                                   "flow divider and combiner with a spool");
}
ComponentType gear_flow_divider_type() {
  return divider_type<GearFlowDividerDef, GearFlowDivider>("gear_flow_divider", kGearFlowDividerFields,
                                                           "flow divider and combiner of two gear units on a shaft");
}

}  // namespace slew::hydraulics
