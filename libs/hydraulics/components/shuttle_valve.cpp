// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/components/shuttle_valve.h"

#include <algorithm>
#include <cmath>

#include "hydraulics/circuit_builder.h"
#include "hydraulics/component.h"
#include "hydraulics/components/check_poppet.h"
#include "hydraulics/components/spring_spool.h"
#include "hydraulics/smooth.h"

namespace slew::hydraulics {
namespace {

constexpr Field kShuttleValveFields[] = {
    field<&ShuttleValveDef::port_1>("port_1", port_options("volume at one inlet")),
    field<&ShuttleValveDef::port_2>("port_2", port_options("volume at the other inlet")),
    field<&ShuttleValveDef::port_3>("port_3", port_options("volume at the outlet")),
    field<&ShuttleValveDef::nominal_flow>("nominal_flow",
                                          nominal_flow_options("flow of the open seat at nominal_pressure_drop")),
    field<&ShuttleValveDef::nominal_pressure_drop>("nominal_pressure_drop", kNominalPressureDrop),
    field<&ShuttleValveDef::switching_pressure>("switching_pressure",
                                                {.dimension = Dimension::pressure,
                                                 .range = kPositive,
                                                 .doc = "difference of the inlets that holds the ball on a seat"}),
};

constexpr double kBallEndWidth = 0.02;  // share of the ball's way, smoothing of its ends

class ShuttleValve final : public HydraulicComponent {
 public:
  ShuttleValve(const ShuttleValveDef& def, CircuitBuilder& builder)
      : HydraulicComponent(def),
        def_(def),
        p_1_(builder.volume(def.port_1)),
        p_2_(builder.volume(def.port_2)),
        p_3_(builder.volume(def.port_3)),
        transition_(builder.def().orifice_transition) {
    apply_parameters();
  }
  void declare_dependencies(DependencyList& dependencies) const override {
    for (const StateIndex row : {p_1_, p_2_, p_3_}) {
      for (const StateIndex column : {p_1_, p_2_, p_3_}) dependencies.add(row, column);
    }
  }
  void add_rates(const CircuitView& view, Rates& rates) const noexcept override {
    rates.move(p_1_, p_3_, flow(view, p_1_).value);
    rates.move(p_2_, p_3_, flow(view, p_2_).value);
  }
  void add_jacobian(const CircuitView& view, JacobianStamp& jacobian) const noexcept override {
    for (const StateIndex inlet : {p_1_, p_2_}) {
      const SeatFlow Q = flow(view, inlet);
      jacobian.move(inlet, p_3_, inlet, Q.over_inlet);
      jacobian.move(inlet, p_3_, other(inlet), Q.over_other);
      jacobian.move(inlet, p_3_, p_3_, -Q.over_inlet - Q.over_other);
      jacobian.move(inlet, p_3_, p_1_, Q.over_position);
      jacobian.move(inlet, p_3_, p_2_, -Q.over_position);
    }
  }
  void list_variables(std::vector<ElementVariable>& variables) const override {
    variables.push_back(variable("position", Dimension::none));
    variables.push_back(variable("flow_1", Dimension::volume_flow));
    variables.push_back(variable("flow_2", Dimension::volume_flow));
  }
  double* read_variables(const CircuitView& view, double* values) const noexcept override {
    *values++ = place(view).value;
    *values++ = flow(view, p_1_).value;
    *values++ = flow(view, p_2_).value;
    return values;
  }
  [[nodiscard]] void* def_address() noexcept override { return &def_; }
  void apply_parameters() noexcept override { K_ = def_.nominal_flow / std::sqrt(def_.nominal_pressure_drop); }

 private:
  // (1) with its slope over p_1 - p_2
  [[nodiscard]] ValueSlope place(const CircuitView& view) const noexcept {
    const double x = (view[p_1_] - view[p_2_]) / def_.switching_pressure;
    const ValueSlope a = unit_clip(0.5 * (1 + x), kBallEndWidth);
    return {a.value, 0.5 * a.slope / def_.switching_pressure};
  }
  struct SeatFlow {
    double value, over_inlet, over_other, over_position;  // m3/s, m3/s/Pa; the position's over p_1 - p_2
  };
  [[nodiscard]] StateIndex other(StateIndex inlet) const noexcept { return inlet == p_1_ ? p_2_ : p_1_; }
  // (2)
  [[nodiscard]] SeatFlow flow(const CircuitView& view, StateIndex inlet) const noexcept {
    const ValueSlope a = place(view);
    const bool is_first = inlet == p_1_;
    const double KA = (is_first ? a.value : 1 - a.value) * K_;
    const ValueSlope in = driven(view[inlet] - view[p_3_]), back = driven(view[p_3_] - view[inlet]);
    const ValueSlope share = rise(view[p_3_] - view[other(inlet)]);
    const double drive = in.value - share.value * back.value;
    return {KA * drive, KA * (in.slope + share.value * back.slope), KA * share.slope * back.value,
            (is_first ? a.slope : -a.slope) * K_ * drive};
  }
  // (4)
  [[nodiscard]] ValueSlope rise(double drop) const noexcept {
    const double t = std::clamp(drop / transition_, 0.0, 1.0);
    return {t * t * t * (10 + t * (6 * t - 15)), 30 * t * t * (1 - t) * (1 - t) / transition_};
  }
  // (3)
  [[nodiscard]] ValueSlope driven(double drop) const noexcept {
    if (drop <= 0) return {0, 0};
    const ValueSlope r = root(drop, transition_), s = rise(drop);
    return {s.value * r.value, s.slope * r.value + s.value * r.slope};
  }

  ShuttleValveDef def_;
  StateIndex p_1_, p_2_, p_3_;
  double transition_;
  double K_ = 0;
};

void validate_shuttle_valve(const HydraulicsDef&, const ComponentDef& component, Problems& errors, Problems&) {
  const ShuttleValveDef& def = static_cast<const ShuttleValveDef&>(component);
  check_distinct(def.name + ".port_2", def.port_1, def.port_2, errors);
  check_distinct(def.name + ".port_3", def.port_1, def.port_3, errors);
  check_distinct(def.name + ".port_3", def.port_2, def.port_3, errors);
}

}  // namespace

ComponentType shuttle_valve_type() {
  return {.name = "shuttle_valve",
          .fields = kShuttleValveFields,
          .doc = "shuttle valve: the outlet takes the inlet of the higher pressure",
          .make_def = []() -> std::unique_ptr<ComponentDef> { return std::make_unique<ShuttleValveDef>(); },
          .validate = validate_shuttle_valve,
          .build = [](const ComponentDef& def, CircuitBuilder& builder) -> std::unique_ptr<HydraulicComponent> {
            return std::make_unique<ShuttleValve>(static_cast<const ShuttleValveDef&>(def), builder);
          }};
}

}  // namespace slew::hydraulics
