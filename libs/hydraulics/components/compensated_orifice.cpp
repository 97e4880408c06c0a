// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/components/compensated_orifice.h"

#include <cmath>
#include "hydraulics/circuit_builder.h"
#include "hydraulics/component.h"
#include "hydraulics/components/ls_tap.h"
#include "hydraulics/oil_properties.h"
#include "hydraulics/pump_lines.h"
#include "hydraulics/smooth.h"

namespace slew::hydraulics {
namespace {

constexpr Field kCompensatedOrificeFields[] = {
    field<&CompensatedOrificeDef::port_p>(
        "port_p", {.presence = Presence::required, .reference = "volume", .doc = "volume at the supply"}),
    field<&CompensatedOrificeDef::port_a>(
        "port_a", {.presence = Presence::required, .reference = "volume", .doc = "volume at the load"}),
    field<&CompensatedOrificeDef::port_t>(
        "port_t", {.presence = Presence::required,
                   .reference = "volume",
                   .doc = "volume of the tank, which the load-sensing pressure is relative to"}),
    field<&CompensatedOrificeDef::area>("area", {.dimension = Dimension::area,
                                                 .range = kPositive,
                                                 .presence = Presence::required,
                                                 .doc = "area of the open orifice"}),
    field<&CompensatedOrificeDef::discharge_coefficient>("discharge_coefficient",
                                                         {.range = kFractionAboveZero, .doc = "discharge coefficient"}),
    field<&CompensatedOrificeDef::compensator_pressure>("compensator_pressure",
                                                        {.dimension = Dimension::pressure,
                                                         .range = kPositive,
                                                         .change = Change::live,
                                                         .doc = "drop that the compensator holds across the orifice"}),
    field<&CompensatedOrificeDef::opening>(
        "opening", {.range = kFraction, .change = Change::live, .doc = "opened fraction of the area"}),
};

constexpr double kSwitchWidth = 2e4;  // Pa, smoothing at the full opening of the compensator and at its load hold

class CompensatedOrifice final : public HydraulicComponent {
 public:
  CompensatedOrifice(const CompensatedOrificeDef& def, CircuitBuilder& builder)
      : HydraulicComponent(def),
        def_(def),
        p_(builder.volume(def.port_p)),
        a_(builder.volume(def.port_a)),
        t_(builder.volume(def.port_t)),
        ls_{.ls = builder.ls_index(def.name), .volume = a_, .tank = t_},
        transition_(builder.def().orifice_transition),
        root_2_rho_(std::sqrt(2 / builder.def().oil_density)) {
    apply_parameters();
  }
  void declare_dependencies(DependencyList& dependencies) const override { dependencies.add_restriction(p_, a_); }
  void add_rates(const CircuitView& view, Rates& rates) const noexcept override {
    rates.move(p_, a_, flow(view[p_] - view[a_]).value);
  }
  void add_jacobian(const CircuitView& view, JacobianStamp& jacobian) const noexcept override {
    const double slope = flow(view[p_] - view[a_]).slope;
    jacobian.move(p_, a_, p_, slope);
    jacobian.move(p_, a_, a_, -slope);
  }
  [[nodiscard]] double ls_pressure(const CircuitView& view) const noexcept override { return ls_.pressure(view); }
  void declare_ls_dependencies(DependencyList& dependencies) const override { ls_.declare_dependencies(dependencies); }
  void add_ls_jacobian(const CircuitView&, JacobianStamp& jacobian) const noexcept override { ls_.stamp(jacobian); }
  void list_variables(std::vector<ElementVariable>& variables) const override {
    variables.push_back(variable("flow", Dimension::volume_flow));
    variables.push_back(variable("ls_pressure", Dimension::pressure));
  }
  double* read_variables(const CircuitView& view, double* values) const noexcept override {
    *values++ = flow(view[p_] - view[a_]).value;
    *values++ = ls_pressure(view);
    return values;
  }
  [[nodiscard]] void* def_address() noexcept override { return &def_; }
  void follow_oil(const PortOil& oil) noexcept override {
    root_2_rho_ = std::sqrt(2 / oil.between(p_, a_).density);
    apply_parameters();
  }
  void apply_parameters() noexcept override {
    K_ = def_.opening * def_.discharge_coefficient * def_.area * root_2_rho_;
  }

 private:
  [[nodiscard]] ValueSlope flow(double drop) const noexcept {
    const ValueSlope available = ramp(drop, kSwitchWidth);
    const ValueSlope held = smooth_min(available.value, def_.compensator_pressure, kSwitchWidth);
    const ValueSlope r = root(held.value, transition_);
    return {K_ * r.value, K_ * r.slope * held.slope * available.slope};
  }

  CompensatedOrificeDef def_;
  StateIndex p_, a_, t_;
  LsTap ls_;
  double transition_, root_2_rho_;
  double K_ = 0;
};

}  // namespace

void CompensatedOrificeDef::add_lines(PumpLines& lines) const {
  if (opening > 0) lines.open.push_back({port_p, port_a});
}

ComponentType compensated_orifice_type() {
  return {.name = "compensated_orifice",
          .fields = kCompensatedOrificeFields,
          .doc = "metering orifice with an ideal pressure compensator",
          .make_def = []() -> std::unique_ptr<ComponentDef> { return std::make_unique<CompensatedOrificeDef>(); },
          .validate = nullptr,
          .build = [](const ComponentDef& def, CircuitBuilder& builder) -> std::unique_ptr<HydraulicComponent> {
            return std::make_unique<CompensatedOrifice>(static_cast<const CompensatedOrificeDef&>(def), builder);
          },
          .has_ls_port = true};
}

}  // namespace slew::hydraulics
