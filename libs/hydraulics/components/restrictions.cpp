// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/components/restrictions.h"

#include <cmath>
#include <numbers>
#include "hydraulics/circuit_builder.h"
#include "hydraulics/component.h"
#include "hydraulics/oil.h"
#include "hydraulics/oil_properties.h"
#include "hydraulics/pump_lines.h"
#include "hydraulics/smooth.h"

namespace slew::hydraulics {
namespace {

constexpr Field kBleedFields[] = {
    field<&BleedDef::port_1>("port_1",
                             {.presence = Presence::required, .reference = "volume", .doc = "volume at one end"}),
    field<&BleedDef::port_2>("port_2",
                             {.presence = Presence::required, .reference = "volume", .doc = "volume at the other end"}),
    field<&BleedDef::nominal_flow>("nominal_flow", {.dimension = Dimension::volume_flow,
                                                    .range = kNotNegative,
                                                    .presence = Presence::required,
                                                    .change = Change::live,
                                                    .doc = "flow at nominal_pressure_drop"}),
    field<&BleedDef::nominal_pressure_drop>("nominal_pressure_drop", {.dimension = Dimension::pressure,
                                                                      .range = kPositive,
                                                                      .presence = Presence::required,
                                                                      .doc = "pressure drop of nominal_flow"}),
};

constexpr Field kOrificeFields[] = {
    field<&OrificeDef::port_1>("port_1",
                               {.presence = Presence::required, .reference = "volume", .doc = "volume at one end"}),
    field<&OrificeDef::port_2>(
        "port_2", {.presence = Presence::required, .reference = "volume", .doc = "volume at the other end"}),
    field<&OrificeDef::diameter>(
        "diameter",
        {.dimension = Dimension::length, .range = kPositive, .presence = Presence::required, .doc = "diameter"}),
    field<&OrificeDef::discharge_coefficient>("discharge_coefficient",
                                              {.range = kFractionAboveZero, .doc = "discharge coefficient"}),
    field<&OrificeDef::opening>("opening",
                                {.range = kFraction, .change = Change::live, .doc = "opened fraction of the area"}),
};

constexpr Field kLaminarRestrictionFields[] = {
    field<&LaminarRestrictionDef::port_1>(
        "port_1", {.presence = Presence::required, .reference = "volume", .doc = "volume at one end"}),
    field<&LaminarRestrictionDef::port_2>(
        "port_2", {.presence = Presence::required, .reference = "volume", .doc = "volume at the other end"}),
    field<&LaminarRestrictionDef::diameter>(
        "diameter",
        {.dimension = Dimension::length, .range = kPositive, .presence = Presence::required, .doc = "inner diameter"}),
    field<&LaminarRestrictionDef::length>(
        "length",
        {.dimension = Dimension::length, .range = kPositive, .presence = Presence::required, .doc = "length"}),
};

// Q = K root(drop) + G drop
struct Conductance {
  double K = 0;  // m3/s/sqrt(Pa)
  double G = 0;  // m3/s/Pa
};

Conductance conductance(const BleedDef& def, const OilProperties&) noexcept {
  return {.K = def.nominal_flow / std::sqrt(def.nominal_pressure_drop)};
}

Conductance conductance(const OrificeDef& def, const OilProperties& oil) noexcept {
  const double area = 0.25 * std::numbers::pi * def.diameter * def.diameter;
  return {.K = def.opening * def.discharge_coefficient * area * std::sqrt(2 / oil.density)};
}

Conductance conductance(const LaminarRestrictionDef& def, const OilProperties& oil) noexcept {
  const double d_2 = def.diameter * def.diameter;
  return {.G = std::numbers::pi * d_2 * d_2 / (128 * oil.density * oil.viscosity * def.length)};
}

// The three types differ only in the source of their conductance.
template <typename Def>
class Restriction final : public HydraulicComponent {
 public:
  Restriction(const Def& def, CircuitBuilder& builder)
      : HydraulicComponent(def),
        def_(def),
        oil_{.density = builder.def().oil_density, .viscosity = builder.def().oil_viscosity},
        p_1_(builder.volume(def.port_1)),
        p_2_(builder.volume(def.port_2)),
        transition_(builder.def().orifice_transition) {
    apply_parameters();
  }
  void declare_dependencies(DependencyList& dependencies) const override { dependencies.add_restriction(p_1_, p_2_); }
  void add_rates(const CircuitView& view, Rates& rates) const noexcept override {
    rates.move(p_1_, p_2_, flow(view).value);
  }
  void add_jacobian(const CircuitView& view, JacobianStamp& jacobian) const noexcept override {
    stamp(jacobian, flow(view).slope);
  }
  void add_rates_and_jacobian(const CircuitView& view, Rates& rates, JacobianStamp& jacobian) const noexcept override {
    const ValueSlope Q = flow(view);
    rates.move(p_1_, p_2_, Q.value);
    stamp(jacobian, Q.slope);
  }
  void list_variables(std::vector<ElementVariable>& variables) const override {
    variables.push_back(variable("flow", Dimension::volume_flow));
  }
  double* read_variables(const CircuitView& view, double* values) const noexcept override {
    *values++ = flow(view).value;
    return values;
  }
  void follow_oil(const PortOil& oil) noexcept override {
    oil_ = oil.between(p_1_, p_2_);
    apply_parameters();
  }
  [[nodiscard]] void* def_address() noexcept override { return &def_; }
  void apply_parameters() noexcept override { c_ = conductance(def_, oil_); }

 private:
  void stamp(JacobianStamp& jacobian, double slope) const noexcept {
    jacobian.move(p_1_, p_2_, p_1_, slope);
    jacobian.move(p_1_, p_2_, p_2_, -slope);
  }
  [[nodiscard]] ValueSlope flow(const CircuitView& view) const noexcept {
    const double drop = view[p_1_] - view[p_2_];
    const ValueSlope r = root(drop, transition_);
    return {c_.K * r.value + c_.G * drop, c_.K * r.slope + c_.G};
  }

  Def def_;
  OilProperties oil_;
  StateIndex p_1_, p_2_;
  double transition_;
  Conductance c_;
};

}  // namespace

void BleedDef::add_lines(PumpLines& lines) const {
  if (!(nominal_flow > 0)) return;
  const double drops = OilCompressibility::kHighest / nominal_pressure_drop;
  lines.open.push_back({port_1, port_2, nominal_flow * std::sqrt(drops)});
}

void OrificeDef::add_lines(PumpLines& lines) const {
  if (!(opening > 0)) return;
  const double area = opening * std::numbers::pi / 4 * diameter * diameter;
  const double speed = discharge_coefficient * std::sqrt(2 * OilCompressibility::kHighest / lines.oil_density);
  lines.open.push_back({port_1, port_2, area * speed});
}

void LaminarRestrictionDef::add_lines(PumpLines& lines) const {
  lines.open.push_back({port_1, port_2});
}

ComponentType bleed_type() {
  return {.name = "bleed",
          .fields = kBleedFields,
          .doc = "restriction given by a nominal flow",
          .make_def = []() -> std::unique_ptr<ComponentDef> { return std::make_unique<BleedDef>(); },
          .validate = nullptr,
          .build = [](const ComponentDef& def, CircuitBuilder& builder) -> std::unique_ptr<HydraulicComponent> {
            return std::make_unique<Restriction<BleedDef>>(static_cast<const BleedDef&>(def), builder);
          }};
}

ComponentType orifice_type() {
  return {.name = "orifice",
          .fields = kOrificeFields,
          .doc = "sharp-edged orifice",
          .make_def = []() -> std::unique_ptr<ComponentDef> { return std::make_unique<OrificeDef>(); },
          .validate = nullptr,
          .build = [](const ComponentDef& def, CircuitBuilder& builder) -> std::unique_ptr<HydraulicComponent> {
            return std::make_unique<Restriction<OrificeDef>>(static_cast<const OrificeDef&>(def), builder);
          }};
}

ComponentType laminar_restriction_type() {
  return {.name = "laminar_restriction",
          .fields = kLaminarRestrictionFields,
          .doc = "thin pipe with laminar flow",
          .make_def = []() -> std::unique_ptr<ComponentDef> { return std::make_unique<LaminarRestrictionDef>(); },
          .validate = nullptr,
          .build = [](const ComponentDef& def, CircuitBuilder& builder) -> std::unique_ptr<HydraulicComponent> {
            return std::make_unique<Restriction<LaminarRestrictionDef>>(static_cast<const LaminarRestrictionDef&>(def),
                                                                        builder);
          }};
}

}  // namespace slew::hydraulics
