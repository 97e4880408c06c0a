// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/components/l90ls_valve.h"

#include <algorithm>
#include <cmath>
#include "hydraulics/circuit_builder.h"
#include "hydraulics/component.h"
#include "hydraulics/components/l90ls_fields.h"
#include "hydraulics/components/l90ls_laws.h"
#include "hydraulics/oil.h"
#include "hydraulics/oil_properties.h"
#include "hydraulics/passages.h"
#include "hydraulics/pump_lines.h"
#include "hydraulics/smooth.h"

namespace slew::hydraulics {
namespace {

constexpr double kOverlapWidth = 1e-3;  // share of the opening, smoothing where the spool's edge uncovers the port
constexpr double kLsOpening = 0.02;     // opening at which the load-sensing port is fully connected
constexpr double kSwitchMargin = 3e4;   // Pa around a switch, range in which the partner receives its steeper side
constexpr double kTimeConstants = 3;    // in a step response, to 95 % of the change

enum Side { kA, kB, kSides };

class L90lsValve final : public HydraulicComponent {
 public:
  L90lsValve(const L90lsValveDef& def, CircuitBuilder& builder)
      : HydraulicComponent(def),
        def_(def),
        p_(builder.volume(def.port_p)),
        t_(builder.volume(def.port_t)),
        port_{builder.volume(def.port_a), builder.volume(def.port_b)},
        spool_(builder.add_state({.initial = 0, .scale = 1})),
        control_(builder.add_control(def.name, SignalMoves::a_state)),
        ls_(builder.ls_index(def.name)),
        transition_(builder.def().orifice_transition) {
    apply_parameters();
    for (const Side side : {kA, kB}) {
      const double setting = side == kA ? def.shock_pressure_a : def.shock_pressure_b;
      builder.add_relief(
          {.valve = def.name, .volume = port_[side], .outlet = t_, .fully_open = setting + def.shock_pressure_rise});
    }
  }

  void declare_dependencies(DependencyList& d) const override {
    d.add(spool_, spool_), d.add(p_, p_), d.add(p_, t_), d.add(p_, spool_), d.add(t_, t_), d.add(t_, spool_);
    for (const StateIndex port : port_) {
      d.add_restriction(p_, port);
      d.add_restriction(port, t_);
      d.add(port, spool_);
    }
  }

  void add_rates(const CircuitView& view, Rates& rates) const noexcept override {
    rates.set_rate(spool_, rate_ * (command(view) - view[spool_]));
    const Openings x = openings(view);
    for (int s = kA; s < kSides; ++s) {
      rates.move(p_, port_[s], supply_flow(view, s, x.supply[s].value).Q);
      rates.move(port_[s], t_, return_flow(view, s, x.supply[1 - s].value).Q);
    }
  }

  void add_jacobian(const CircuitView& view, JacobianStamp& jacobian) const noexcept override {
    jacobian.add(spool_, spool_, -rate_);
    const Openings x = openings(view);
    for (int s = kA; s < kSides; ++s) {
      stamp_supply(jacobian, s, supply_flow(view, s, x.supply[s].value), x.supply[s].slope);
      stamp_return(jacobian, s, return_flow(view, s, x.supply[1 - s].value), x.supply[1 - s].slope);
    }
  }

  void add_rates_and_jacobian(const CircuitView& view, Rates& rates, JacobianStamp& jacobian) const noexcept override {
    rates.set_rate(spool_, rate_ * (command(view) - view[spool_]));
    jacobian.add(spool_, spool_, -rate_);
    const Openings x = openings(view);
    for (int s = kA; s < kSides; ++s) {
      const SupplyFlow in = supply_flow(view, s, x.supply[s].value);
      const ReturnFlow out = return_flow(view, s, x.supply[1 - s].value);
      rates.move(p_, port_[s], in.Q);
      rates.move(port_[s], t_, out.Q);
      stamp_supply(jacobian, s, in, x.supply[s].slope);
      stamp_return(jacobian, s, out, x.supply[1 - s].slope);
    }
  }

  void follow_oil(const PortOil& oil) noexcept override {
    fluidity_ = oil.fluidity(p_, t_);
    apply_parameters();
  }
  void add_passages(const CircuitView& view, Passages& passages) const noexcept override {
    const Openings x = openings(view);
    for (int s = kA; s < kSides; ++s) {
      passages.move(p_, port_[s], supply_flow(view, s, x.supply[s].value).Q);
      passages.move(port_[s], t_, return_flow(view, s, x.supply[1 - s].value).Q);
    }
  }

  // equation (7)
  [[nodiscard]] double ls_pressure(const CircuitView& view) const noexcept override {
    const Openings x = openings(view);
    double ls = 0;
    for (int s = kA; s < kSides; ++s) {
      // a closed side is not connected
      if (x.supply[s].value > 0) ls += ls_share(x.supply[s].value).value * sensed(view, s).value;
    }
    return ls;
  }
  void declare_ls_dependencies(DependencyList& dependencies) const override {
    for (const StateIndex i : {port_[kA], port_[kB], t_, spool_}) dependencies.add(dependencies.ls_row(ls_), i);
  }
  void add_ls_jacobian(const CircuitView& view, JacobianStamp& jacobian) const noexcept override {
    const StateIndex row = jacobian.ls_row(ls_);
    const Openings x = openings(view);
    for (int s = kA; s < kSides; ++s) {
      if (!(x.supply[s].value > 0)) continue;
      const ValueSlope share = ls_share(x.supply[s].value), pressure = sensed(view, s);
      jacobian.add(row, port_[s], share.value * pressure.slope);
      jacobian.add(row, t_, -share.value * pressure.slope);
      jacobian.add(row, spool_, share.slope * x.supply[s].slope * pressure.value);
    }
  }

  void raise_slopes(const CircuitView& view, JacobianStamp& slopes) const noexcept override {
    const Openings x = openings(view);
    for (int s = kA; s < kSides; ++s) {
      double rise = steeper_return_slope(law_[s], view[port_[s]] - view[t_], kSwitchMargin);
      // just before the lock-hold opens: use the slope after opening
      const double drop = view[p_] - view[port_[s]];
      if (x.supply[s].value > 0 && std::fabs(drop) <= kSwitchMargin) {
        const double load = view[port_[s]] - view[t_];
        const SupplyFlow now = supply(law_[s], x.supply[s].value, drop, load);
        const SupplyFlow open = supply(law_[s], x.supply[s].value, std::max(drop, 0.0) + kSwitchMargin, load);
        rise += std::max(0.0, (open.d_drop - open.d_load) - (now.d_drop - now.d_load));
      }
      slopes.add(port_[s], port_[s], -rise);
    }
  }
  [[nodiscard]] std::uint32_t flags(const CircuitView& view) const noexcept override {
    const bool is_open = is_shock_open(view, kA) || is_shock_open(view, kB);
    return is_open ? static_cast<std::uint32_t>(StepFlag::relief_open) : 0;
  }

  void list_variables(std::vector<ElementVariable>& variables) const override {
    variables.push_back(variable("control_signal", Dimension::electric_signal));
    variables.push_back(variable("spool_position", Dimension::none));
    variables.push_back(variable("opening", Dimension::none));
    for (const char* flow : {"flow_pa", "flow_at", "flow_pb", "flow_bt", "shock_flow_a", "shock_flow_b",
                             "anti_cavitation_flow_a", "anti_cavitation_flow_b"}) {
      variables.push_back(variable(flow, Dimension::volume_flow));
    }
    variables.push_back(variable("ls_pressure", Dimension::pressure));
    variables.push_back(variable("is_shock_open", Dimension::none));
  }
  double* read_variables(const CircuitView& view, double* values) const noexcept override;

  [[nodiscard]] void* def_address() noexcept override { return &def_; }
  void apply_parameters() noexcept override;

 private:
  // x_A and x_B of (1) with their slopes over the spool position; the return edge of one side opens with the
  // supply edge of the other
  struct Openings {
    ValueSlope supply[kSides];
  };

  [[nodiscard]] double command(const CircuitView& view) const noexcept {
    const double limit = def_.maximum_control_signal;
    return std::clamp(view.control[control_], -limit, limit) / def_.nominal_control_signal;
  }
  [[nodiscard]] Openings openings(const CircuitView& view) const noexcept {
    const double xs = view[spool_];
    const ValueSlope a = ramp((xs - def_.overlap) * gain_, kOverlapWidth);
    const ValueSlope b = ramp((-xs - def_.overlap) * gain_, kOverlapWidth);
    return {{{a.value, a.slope * gain_}, {b.value, -b.slope * gain_}}};
  }
  [[nodiscard]] SupplyFlow supply_flow(const CircuitView& view, int s, double opening) const noexcept {
    return supply(law_[s], opening, view[p_] - view[port_[s]], view[port_[s]] - view[t_]);
  }
  void stamp_supply(JacobianStamp& jacobian, int s, const SupplyFlow& in, double opening_slope) const noexcept {
    const StateIndex port = port_[s];
    jacobian.move(p_, port, spool_, in.d_opening * opening_slope);
    jacobian.move(p_, port, p_, in.d_drop);
    jacobian.move(p_, port, port, in.d_load - in.d_drop);
    jacobian.move(p_, port, t_, -in.d_load);
  }
  void stamp_return(JacobianStamp& jacobian, int s, const ReturnFlow& out, double opening_slope) const noexcept {
    const StateIndex port = port_[s];
    jacobian.move(port, t_, spool_, out.d_opening * opening_slope);
    jacobian.move(port, t_, port, out.d_drop);
    jacobian.move(port, t_, t_, -out.d_drop);
  }
  [[nodiscard]] ReturnFlow return_flow(const CircuitView& view, int s, double opening) const noexcept {
    return to_tank(law_[s], opening, view[port_[s]] - view[t_]);
  }
  [[nodiscard]] ValueSlope sensed(const CircuitView& view, int s) const noexcept {
    return smooth_min(view[port_[s]] - view[t_], law_[s].maximum_ls, kLsWidth);
  }
  [[nodiscard]] static ValueSlope ls_share(double opening) noexcept {
    const double t = std::min(opening / kLsOpening, 1.0);
    return {t * t * (3 - 2 * t), 6 * t * (1 - t) / kLsOpening};
  }
  [[nodiscard]] bool is_shock_open(const CircuitView& view, int s) const noexcept {
    return shock(law_[s], view[port_[s]] - view[t_]).value > 0;
  }

  L90lsValveDef def_;
  StateIndex p_, t_;
  StateIndex port_[kSides];
  StateIndex spool_;  // -1..1 at the nominal signal
  int control_;
  LsIndex ls_;
  double transition_;
  double fluidity_ = 1;  // of the oil, for leaks
  double rate_ = 0;      // 1/tau
  double gain_ = 0;      // 1/(1 - overlap)
  L90Side law_[kSides];
};

void L90lsValve::apply_parameters() noexcept {
  rate_ = kTimeConstants / def_.step_response;
  gain_ = 1 / (1 - def_.overlap);
  const double root_drop = std::sqrt(def_.nominal_pressure_drop);
  const double K_comp = def_.compensator_flow / std::sqrt(def_.compensator_pressure_drop);
  const L90Side common{.K_comp_2 = K_comp * K_comp,
                       .compensator_pressure = def_.compensator_pressure,
                       .opening_rise = def_.opening_pressure_rise,
                       .G_leak = fluidity_ * def_.leak_flow / def_.leak_pressure,
                       .shock_rise = def_.shock_pressure_rise,
                       .K_anti_cavitation = def_.anti_cavitation_flow / std::sqrt(def_.anti_cavitation_pressure_drop -
                                                                                  def_.anti_cavitation_crack_pressure),
                       .crack = def_.anti_cavitation_crack_pressure,
                       .transition = transition_};
  const double supply_flows[] = {def_.nominal_flow_pa, def_.nominal_flow_pb};
  const double return_flows[] = {def_.nominal_flow_at, def_.nominal_flow_bt};
  const double settings[] = {def_.shock_pressure_a, def_.shock_pressure_b};
  const double ls_limits[] = {def_.maximum_ls_pressure_a, def_.maximum_ls_pressure_b};
  for (int s = kA; s < kSides; ++s) {
    law_[s] = common;
    law_[s].K_supply = supply_flows[s] / root_drop;
    law_[s].K_return = return_flows[s] / root_drop;
    law_[s].maximum_ls = ls_limits[s];
    law_[s].shock_setting = settings[s];
    law_[s].K_shock = def_.shock_flow / std::sqrt(settings[s] + def_.shock_pressure_rise);
  }
}

double* L90lsValve::read_variables(const CircuitView& view, double* values) const noexcept {
  const Openings x = openings(view);
  const double drop_a = view[port_[kA]] - view[t_], drop_b = view[port_[kB]] - view[t_];
  *values++ = view.control[control_];
  *values++ = view[spool_];
  *values++ = x.supply[kA].value - x.supply[kB].value;
  *values++ = supply_flow(view, kA, x.supply[kA].value).Q;
  *values++ = law_[kA].K_return * x.supply[kB].value * root(drop_a, transition_).value;
  *values++ = supply_flow(view, kB, x.supply[kB].value).Q;
  *values++ = law_[kB].K_return * x.supply[kA].value * root(drop_b, transition_).value;
  *values++ = shock(law_[kA], drop_a).value;
  *values++ = shock(law_[kB], drop_b).value;
  *values++ = -anti_cavitation(law_[kA], drop_a).value;
  *values++ = -anti_cavitation(law_[kB], drop_b).value;
  *values++ = view.ls[ls_];
  *values++ = is_shock_open(view, kA) || is_shock_open(view, kB) ? 1 : 0;
  return values;
}

void validate_valve(const HydraulicsDef& circuit, const ComponentDef& component, Problems& errors, Problems& warnings) {
  const L90lsValveDef& def = static_cast<const L90lsValveDef&>(component);
  if (!(def.anti_cavitation_pressure_drop > def.anti_cavitation_crack_pressure)) {
    errors.push_back({def.name + ".anti_cavitation_pressure_drop",
                      "the anti-cavitation valve is stated at a drop at which it is still closed",
                      "more than anti_cavitation_crack_pressure", ""});
  }
  if (def.nominal_control_signal > def.maximum_control_signal) {
    warnings.push_back(
        {def.name + ".nominal_control_signal", "the valve never opens fully", "at most maximum_control_signal", ""});
  }
  if (def.port_a == def.port_b) {
    errors.push_back({def.name + ".port_b", "ports A and B are connected to '" + def.port_a + "'", "two volumes", ""});
  }
  for (const VolumeDef& volume : circuit.volumes) {
    if (volume.name != def.port_t || volume.fixed) continue;
    errors.push_back({def.name + ".port_t",
                      "the valve has no tank: '" + def.port_t + "' is not held at a fixed pressure",
                      "a volume with fixed: true", ""});
  }
}

}  // namespace

void L90lsValveDef::add_lines(PumpLines& lines) const {
  const double settings[] = {shock_pressure_a, shock_pressure_b};
  for (const int side : {kA, kB}) {
    if (!(settings[side] < OilCompressibility::kHighest)) continue;
    const double drops = OilCompressibility::kHighest / (settings[side] + shock_pressure_rise);
    lines.open.push_back(
        {.a = side == kA ? port_a : port_b, .b = port_t, .flow = shock_flow * std::sqrt(drops), .is_one_way = true});
  }
}

ComponentType l90ls_valve_type() {
  return {.name = "l90ls_valve",
          .fields = kL90lsValveFields,
          .doc = "pressure-compensated load-sensing directional valve",
          .make_def = []() -> std::unique_ptr<ComponentDef> { return std::make_unique<L90lsValveDef>(); },
          .validate = validate_valve,
          .build = [](const ComponentDef& def, CircuitBuilder& builder) -> std::unique_ptr<HydraulicComponent> {
            return std::make_unique<L90lsValve>(static_cast<const L90lsValveDef&>(def), builder);
          },
          .has_control_signal = true,
          .has_ls_port = true};
}

}  // namespace slew::hydraulics
