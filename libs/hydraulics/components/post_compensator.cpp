// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/components/post_compensator.h"

#include <cmath>

#include "hydraulics/circuit_builder.h"
#include "hydraulics/component.h"
#include "hydraulics/components/check_poppet.h"
#include "hydraulics/smooth.h"

namespace slew::hydraulics {
namespace {

constexpr Field kPostCompensatorFields[] = {
    field<&PostCompensatorDef::port_1>(
        "port_1", {.presence = Presence::required, .reference = "volume", .doc = "volume behind the metering edge"}),
    field<&PostCompensatorDef::port_2>(
        "port_2", {.presence = Presence::required, .reference = "volume", .doc = "volume before the load"}),
    field<&PostCompensatorDef::port_t>("port_t", {.presence = Presence::required,
                                                  .reference = "volume",
                                                  .doc = "tank, which load-sensing pressures are relative to"}),
    field<&PostCompensatorDef::shared_ls>("shared_ls",
                                          {.presence = Presence::required,
                                           .reference = "component",
                                           .doc = "component with the highest load-sensing pressure of all sections"}),
    field<&PostCompensatorDef::spring_pressure>(
        "spring_pressure", {.dimension = Dimension::pressure,
                            .range = kNotNegative,
                            .change = Change::live,
                            .doc = "pressure above the shared one at which the compensator begins to open"}),
    field<&PostCompensatorDef::regulation_pressure>(
        "regulation_pressure",
        {.dimension = Dimension::pressure, .range = kPositive, .doc = "rise that opens the compensator fully"}),
    field<&PostCompensatorDef::nominal_flow>("nominal_flow",
                                             {.dimension = Dimension::volume_flow,
                                              .range = kPositive,
                                              .presence = Presence::required,
                                              .change = Change::live,
                                              .doc = "flow of the open compensator at nominal_pressure_drop"}),
    field<&PostCompensatorDef::nominal_pressure_drop>(
        "nominal_pressure_drop",
        {.dimension = Dimension::pressure, .range = kPositive, .doc = "pressure drop of nominal_flow"}),
    field<&PostCompensatorDef::step_response>("step_response", {.dimension = Dimension::time,
                                                                .range = kPositive,
                                                                .change = Change::live,
                                                                .doc = "three time constants of the opening"}),
};

constexpr double kCompensatorEndWidth = 0.02;    // share of the opening, smoothing of its limits
constexpr double kCompensatorTimeConstants = 3;  // in a step response, to 95 % of the change
constexpr double kLoadCheckWidth = 2e4;          // Pa, smoothing of the load check

class PostCompensator final : public HydraulicComponent {
 public:
  PostCompensator(const PostCompensatorDef& def, CircuitBuilder& builder)
      : HydraulicComponent(def),
        def_(def),
        p_1_(builder.volume(def.port_1)),
        p_2_(builder.volume(def.port_2)),
        t_(builder.volume(def.port_t)),
        own_ls_(builder.ls_index(def.name)),
        shared_ls_(builder.ls_index(def.shared_ls)),
        u_(builder.add_state({.initial = 0, .scale = 1})),
        transition_(builder.def().orifice_transition) {
    apply_parameters();
  }
  void declare_dependencies(DependencyList& dependencies) const override {
    dependencies.add_restriction(p_1_, p_2_);
    for (const StateIndex row : {p_1_, p_2_, u_}) dependencies.add(row, u_);
    dependencies.add(u_, p_1_), dependencies.add(u_, t_);
    dependencies.add_ls(u_, shared_ls_);
  }
  void add_rates(const CircuitView& view, Rates& rates) const noexcept override {
    rates.set_rate(u_, rate_ * (command(view).value - view[u_]));
    rates.move(p_1_, p_2_, opening(view) * through(view).value);
  }
  void add_jacobian(const CircuitView& view, JacobianStamp& jacobian) const noexcept override {
    const double d_inlet = rate_ * command(view).slope;
    const ValueSlope Q = through(view);
    jacobian.add(u_, u_, -rate_);
    jacobian.add(u_, p_1_, d_inlet);
    jacobian.add(u_, t_, -d_inlet);
    jacobian.add_ls(u_, shared_ls_, -d_inlet);
    if (view[u_] > 0) jacobian.move(p_1_, p_2_, u_, Q.value);
    jacobian.move(p_1_, p_2_, p_1_, opening(view) * Q.slope);
    jacobian.move(p_1_, p_2_, p_2_, -opening(view) * Q.slope);
  }
  // (3)
  [[nodiscard]] double ls_pressure(const CircuitView& view) const noexcept override { return view[p_2_] - view[t_]; }
  void declare_ls_dependencies(DependencyList& dependencies) const override {
    dependencies.add(dependencies.ls_row(own_ls_), p_2_);
    dependencies.add(dependencies.ls_row(own_ls_), t_);
  }
  void add_ls_jacobian(const CircuitView&, JacobianStamp& jacobian) const noexcept override {
    jacobian.add(jacobian.ls_row(own_ls_), p_2_, 1);
    jacobian.add(jacobian.ls_row(own_ls_), t_, -1);
  }
  void list_variables(std::vector<ElementVariable>& variables) const override {
    variables.push_back(variable("opening", Dimension::none));
    variables.push_back(variable("flow", Dimension::volume_flow));
    variables.push_back(variable("ls_pressure", Dimension::pressure));
  }
  double* read_variables(const CircuitView& view, double* values) const noexcept override {
    *values++ = view[u_];
    *values++ = opening(view) * through(view).value;
    *values++ = ls_pressure(view);
    return values;
  }
  [[nodiscard]] void* def_address() noexcept override { return &def_; }
  void apply_parameters() noexcept override {
    K_ = def_.nominal_flow / std::sqrt(def_.nominal_pressure_drop);
    rate_ = kCompensatorTimeConstants / def_.step_response;
  }

 private:
  [[nodiscard]] double opening(const CircuitView& view) const noexcept { return std::fmax(view[u_], 0); }
  // command of (1), with its slope over p_1
  [[nodiscard]] ValueSlope command(const CircuitView& view) const noexcept {
    const double over = view[p_1_] - view[t_] - view.ls[shared_ls_] - def_.spring_pressure;
    const ValueSlope u = unit_clip(over / def_.regulation_pressure, kCompensatorEndWidth);
    return {u.value, u.slope / def_.regulation_pressure};
  }
  // flow of (2) at full opening, with its slope over the drop
  [[nodiscard]] ValueSlope through(const CircuitView& view) const noexcept {
    const ValueSlope drop = ramp(view[p_1_] - view[p_2_], kLoadCheckWidth), r = root(drop.value, transition_);
    return {K_ * r.value, K_ * r.slope * drop.slope};
  }

  PostCompensatorDef def_;
  StateIndex p_1_, p_2_, t_;
  LsIndex own_ls_, shared_ls_;
  StateIndex u_;  // 0..1
  double transition_;
  double K_ = 0, rate_ = 0;
};

void validate_post_compensator(const HydraulicsDef&, const ComponentDef& component, Problems& errors, Problems&) {
  const PostCompensatorDef& def = static_cast<const PostCompensatorDef&>(component);
  check_distinct(def.name + ".port_2", def.port_1, def.port_2, errors);
}

}  // namespace

ComponentType post_compensator_type() {
  return {.name = "post_compensator",
          .fields = kPostCompensatorFields,
          .doc = "compensator behind a metering edge: sections share the pump's flow",
          .make_def = []() -> std::unique_ptr<ComponentDef> { return std::make_unique<PostCompensatorDef>(); },
          .validate = validate_post_compensator,
          .build = [](const ComponentDef& def, CircuitBuilder& builder) -> std::unique_ptr<HydraulicComponent> {
            return std::make_unique<PostCompensator>(static_cast<const PostCompensatorDef&>(def), builder);
          },
          .has_ls_port = true};
}

}  // namespace slew::hydraulics
