// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/components/flushing_valve.h"

#include <cmath>

#include "hydraulics/circuit_builder.h"
#include "hydraulics/component.h"
#include "hydraulics/components/check_poppet.h"
#include "hydraulics/components/spring_spool.h"
#include "hydraulics/smooth.h"

namespace slew::hydraulics {
namespace {

constexpr Field kFlushingValveFields[] = {
    field<&FlushingValveDef::port_1>("port_1", port_options("volume of one side of the closed circuit")),
    field<&FlushingValveDef::port_2>("port_2", port_options("volume of the other side")),
    field<&FlushingValveDef::port_3>("port_3", port_options("volume that takes the oil of the lower side")),
    field<&FlushingValveDef::nominal_flow>("nominal_flow",
                                           nominal_flow_options("flow of an open edge at nominal_pressure_drop")),
    field<&FlushingValveDef::nominal_pressure_drop>("nominal_pressure_drop", kNominalPressureDrop),
    field<&FlushingValveDef::switching_pressure>("switching_pressure",
                                                 {.dimension = Dimension::pressure,
                                                  .range = kNotNegative,
                                                  .change = Change::live,
                                                  .doc = "difference of the sides from which on an edge opens"}),
    field<&FlushingValveDef::opening_pressure_rise>(
        "opening_pressure_rise",
        {.dimension = Dimension::pressure, .range = kPositive, .doc = "rise from shut to fully open"}),
};

constexpr double kFlushingEndWidth = 0.02;  // share of the spool's way, smoothing of its ends

class FlushingValve final : public HydraulicComponent {
 public:
  FlushingValve(const FlushingValveDef& def, CircuitBuilder& builder)
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
    rates.move(p_1_, p_3_, flow(view, p_1_, p_2_).value);
    rates.move(p_2_, p_3_, flow(view, p_2_, p_1_).value);
  }
  void add_jacobian(const CircuitView& view, JacobianStamp& jacobian) const noexcept override {
    for (const auto& [side, other] : {std::pair(p_1_, p_2_), std::pair(p_2_, p_1_)}) {
      const EdgeFlow Q = flow(view, side, other);
      jacobian.move(side, p_3_, side, Q.over_drop - Q.over_position);
      jacobian.move(side, p_3_, p_3_, -Q.over_drop);
      jacobian.move(side, p_3_, other, Q.over_position);
    }
  }
  void list_variables(std::vector<ElementVariable>& variables) const override {
    variables.push_back(variable("opening_1", Dimension::none));
    variables.push_back(variable("opening_2", Dimension::none));
    variables.push_back(variable("flow_1", Dimension::volume_flow));
    variables.push_back(variable("flow_2", Dimension::volume_flow));
  }
  double* read_variables(const CircuitView& view, double* values) const noexcept override {
    *values++ = opening(view, p_1_, p_2_).value;
    *values++ = opening(view, p_2_, p_1_).value;
    *values++ = flow(view, p_1_, p_2_).value;
    *values++ = flow(view, p_2_, p_1_).value;
    return values;
  }
  [[nodiscard]] void* def_address() noexcept override { return &def_; }
  void apply_parameters() noexcept override { K_ = def_.nominal_flow / std::sqrt(def_.nominal_pressure_drop); }

 private:
  // (1) with its slope over the other side's pressure
  [[nodiscard]] ValueSlope opening(const CircuitView& view, StateIndex side, StateIndex other) const noexcept {
    const double rise = def_.opening_pressure_rise;
    const ValueSlope u = unit_clip((view[other] - view[side] - def_.switching_pressure) / rise, kFlushingEndWidth);
    return {u.value, u.slope / rise};
  }
  // (2); over_position: over the other side's pressure by the spool
  [[nodiscard]] EdgeFlow flow(const CircuitView& view, StateIndex side, StateIndex other) const noexcept {
    const ValueSlope u = opening(view, side, other), r = root(view[side] - view[p_3_], transition_);
    return {u.value * K_ * r.value, u.value * K_ * r.slope, u.slope * K_ * r.value};
  }

  FlushingValveDef def_;
  StateIndex p_1_, p_2_, p_3_;
  double transition_;
  double K_ = 0;
};

void validate_flushing_valve(const HydraulicsDef&, const ComponentDef& component, Problems& errors, Problems&) {
  const FlushingValveDef& def = static_cast<const FlushingValveDef&>(component);
  check_distinct(def.name + ".port_2", def.port_1, def.port_2, errors);
  check_distinct(def.name + ".port_3", def.port_1, def.port_3, errors);
  check_distinct(def.name + ".port_3", def.port_2, def.port_3, errors);
}

}  // namespace

ComponentType flushing_valve_type() {
  return {.name = "flushing_valve",
          .fields = kFlushingValveFields,
          .doc = "flushing valve of a closed circuit: the outlet takes oil of the side of the lower pressure",
          .make_def = []() -> std::unique_ptr<ComponentDef> { return std::make_unique<FlushingValveDef>(); },
          .validate = validate_flushing_valve,
          .build = [](const ComponentDef& def, CircuitBuilder& builder) -> std::unique_ptr<HydraulicComponent> {
            return std::make_unique<FlushingValve>(static_cast<const FlushingValveDef&>(def), builder);
          }};
}

}  // namespace slew::hydraulics
