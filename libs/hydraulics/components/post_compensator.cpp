// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/components/post_compensator.h"

#include "hydraulics/circuit_builder.h"
#include "hydraulics/component.h"
#include "hydraulics/components/ls_tap.h"
#include "hydraulics/components/shared_fields.h"
#include "hydraulics/components/spring_spool.h"
#include "hydraulics/smooth.h"

namespace slew::hydraulics {
namespace {

constexpr Field kPostCompensatorFields[] = {
    field<&PostCompensatorDef::port_1>("port_1", port_options("volume behind the metering edge")),
    field<&PostCompensatorDef::port_2>("port_2", port_options("volume before the load")),
    field<&PostCompensatorDef::port_t>(
        "port_t", port_options("volume of the tank, which load-sensing pressures are relative to")),
    field<&PostCompensatorDef::shared_ls>("shared_ls", {.presence = Presence::required,
                                                        .reference = "component",
                                                        .doc = "component with the highest load-sensing pressure"}),
    field<&PostCompensatorDef::spring_pressure>("spring_pressure",
                                                {.dimension = Dimension::pressure,
                                                 .range = kNotNegative,
                                                 .change = Change::live,
                                                 .doc = "pressure above the shared one at which it begins to open"}),
    field<&PostCompensatorDef::regulation_pressure>(
        "regulation_pressure",
        {.dimension = Dimension::pressure, .range = kPositive, .doc = "rise that opens the compensator fully"}),
    field<&PostCompensatorDef::nominal_flow>("nominal_flow",
                                             nominal_flow_options("flow of the open valve at nominal_pressure_drop")),
    field<&PostCompensatorDef::nominal_pressure_drop>("nominal_pressure_drop", kNominalPressureDrop),
    field<&PostCompensatorDef::step_response>("step_response",
                                              step_response_options("three time constants of the opening")),
};

constexpr double kLoadCheckWidth = 2e4;  // Pa, smoothing of the load check

class PostCompensator final : public HydraulicComponent {
 public:
  PostCompensator(const PostCompensatorDef& def, CircuitBuilder& builder)
      : HydraulicComponent(def),
        def_(def),
        p_1_(builder.volume(def.port_1)),
        p_2_(builder.volume(def.port_2)),
        t_(builder.volume(def.port_t)),
        own_ls_{.ls = builder.ls_index(def.name), .volume = p_2_, .tank = t_},
        shared_ls_(builder.ls_index(def.shared_ls)),
        u_(builder.add_state({.initial = 0, .scale = 1})),
        transition_(builder.def().orifice_transition),
        spool_(u_, transition_) {
    apply_parameters();
  }
  void declare_dependencies(DependencyList& dependencies) const override {
    dependencies.add_restriction(p_1_, p_2_);
    for (const StateIndex row : {p_1_, p_2_, u_}) dependencies.add(row, u_);
    dependencies.add(u_, p_1_), dependencies.add(u_, t_);
    dependencies.add_ls(u_, shared_ls_);
  }
  void add_rates(const CircuitView& view, Rates& rates) const noexcept override {
    spool_.add_rate(view, command(view).value, rates);
    rates.move(p_1_, p_2_, spool_.opening(view).value * through(view).value);
  }
  void add_jacobian(const CircuitView& view, JacobianStamp& jacobian) const noexcept override {
    const double slope = command(view).slope;
    spool_.stamp_rate(p_1_, t_, slope, jacobian);
    jacobian.add_ls(u_, shared_ls_, -(spool_.rate() * slope));
    const ValueSlope Q = through(view), u = spool_.opening(view);
    spool_.stamp_edge(p_1_, p_2_, {u.value * Q.value, u.value * Q.slope, u.slope * Q.value}, jacobian);
  }
  // (3)
  [[nodiscard]] double ls_pressure(const CircuitView& view) const noexcept override { return own_ls_.pressure(view); }
  void declare_ls_dependencies(DependencyList& dependencies) const override {
    own_ls_.declare_dependencies(dependencies);
  }
  void add_ls_jacobian(const CircuitView&, JacobianStamp& jacobian) const noexcept override { own_ls_.stamp(jacobian); }
  void list_variables(std::vector<ElementVariable>& variables) const override {
    variables.push_back(variable("opening", Dimension::none));
    variables.push_back(variable("flow", Dimension::volume_flow));
    variables.push_back(variable("ls_pressure", Dimension::pressure));
  }
  double* read_variables(const CircuitView& view, double* values) const noexcept override {
    *values++ = view[u_];
    *values++ = spool_.opening(view).value * through(view).value;
    *values++ = ls_pressure(view);
    return values;
  }
  [[nodiscard]] void* def_address() noexcept override { return &def_; }
  void apply_parameters() noexcept override {
    spool_.set(def_.nominal_flow, def_.nominal_pressure_drop, def_.step_response);
  }

 private:
  // command of (1), with its slope over p_1
  [[nodiscard]] ValueSlope command(const CircuitView& view) const noexcept {
    const double over = view[p_1_] - view[t_] - view.ls[shared_ls_] - def_.spring_pressure;
    const ValueSlope u = unit_clip(over / def_.regulation_pressure, SpringSpool::kEndWidth);
    return {u.value, u.slope / def_.regulation_pressure};
  }
  // flow of (2) at full opening, with its slope over the drop
  [[nodiscard]] ValueSlope through(const CircuitView& view) const noexcept {
    const ValueSlope drop = ramp(view[p_1_] - view[p_2_], kLoadCheckWidth), r = root(drop.value, transition_);
    return {spool_.K() * r.value, spool_.K() * r.slope * drop.slope};
  }

  PostCompensatorDef def_;
  StateIndex p_1_, p_2_, t_;
  LsTap own_ls_;
  LsIndex shared_ls_;
  StateIndex u_;  // 0..1
  double transition_;
  SpringSpool spool_;
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
