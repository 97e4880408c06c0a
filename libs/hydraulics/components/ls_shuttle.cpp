// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/components/ls_shuttle.h"

#include "hydraulics/circuit_builder.h"
#include "hydraulics/component.h"
#include "hydraulics/smooth.h"

namespace slew::hydraulics {
namespace {

constexpr Field kLsShuttleFields[] = {
    field<&LsShuttleDef::port_1>("port_1", {.presence = Presence::required,
                                            .reference = "component",
                                            .doc = "valve or shuttle with a load-sensing pressure"}),
    field<&LsShuttleDef::port_2>("port_2", {.presence = Presence::required,
                                            .reference = "component",
                                            .doc = "valve or shuttle with a load-sensing pressure"}),
    field<&LsShuttleDef::line_time_constant>("line_time_constant",
                                             {.dimension = Dimension::time,
                                              .range = kNotNegative,
                                              .doc = "time constant of the LS line behind the shuttle; 0: none"}),
};

constexpr double kShuttleSwitchWidth = 1e4;  // Pa over which the shuttle changes over
constexpr double kLineScale = 1e6;           // Pa, typical LS pressure

class LsShuttle final : public HydraulicComponent {
 public:
  LsShuttle(const LsShuttleDef& def, CircuitBuilder& builder)
      : HydraulicComponent(def),
        def_(def),
        input_1_(builder.ls_index(def.port_1)),
        input_2_(builder.ls_index(def.port_2)),
        own_(builder.ls_index(def.name)) {
    if (def.line_time_constant > 0) {
      line_ = builder.add_state({.initial = 0, .scale = kLineScale});
      rate_ = 1 / def.line_time_constant;
    }
  }
  [[nodiscard]] bool has_equations() const noexcept override { return has_line(); }
  void declare_dependencies(DependencyList& dependencies) const override {
    if (!has_line()) return;
    dependencies.add_ls(line_, input_1_);
    dependencies.add_ls(line_, input_2_);
    dependencies.add(line_, line_);
  }
  void add_rates(const CircuitView& view, Rates& rates) const noexcept override {
    if (has_line()) rates.set_rate(line_, rate_ * (higher(view).value - view[line_]));
  }
  void add_jacobian(const CircuitView& view, JacobianStamp& jacobian) const noexcept override {
    if (!has_line()) return;
    const double share = higher(view).slope;
    jacobian.add(line_, line_, -rate_);
    jacobian.add_ls(line_, input_1_, rate_ * share);
    jacobian.add_ls(line_, input_2_, rate_ * (1 - share));
  }

  [[nodiscard]] std::vector<LsIndex> ls_inputs() const override {
    return has_line() ? std::vector<LsIndex>{} : std::vector<LsIndex>{input_1_, input_2_};
  }
  [[nodiscard]] double ls_pressure(const CircuitView& view) const noexcept override {
    return has_line() ? view[line_] : higher(view).value;
  }
  void declare_ls_dependencies(DependencyList& dependencies) const override {
    const StateIndex row = dependencies.ls_row(own_);
    if (has_line()) {
      dependencies.add(row, line_);
    } else {
      dependencies.add_ls(row, input_1_);
      dependencies.add_ls(row, input_2_);
    }
  }
  void add_ls_jacobian(const CircuitView& view, JacobianStamp& jacobian) const noexcept override {
    const StateIndex row = jacobian.ls_row(own_);
    if (has_line()) {
      jacobian.add(row, line_, 1);
      return;
    }
    const double share = higher(view).slope;
    jacobian.add_ls(row, input_1_, share);
    jacobian.add_ls(row, input_2_, 1 - share);
  }

  void list_variables(std::vector<ElementVariable>& variables) const override {
    variables.push_back(variable("ls_pressure", Dimension::pressure));
  }
  double* read_variables(const CircuitView& view, double* values) const noexcept override {
    *values++ = view.ls[own_];
    return values;
  }
  [[nodiscard]] void* def_address() noexcept override { return &def_; }
  void apply_parameters() noexcept override {}

 private:
  [[nodiscard]] bool has_line() const noexcept { return line_ >= 0; }
  [[nodiscard]] ValueSlope higher(const CircuitView& view) const noexcept {
    return smooth_max(view.ls[input_1_], view.ls[input_2_], kShuttleSwitchWidth);
  }

  LsShuttleDef def_;
  LsIndex input_1_, input_2_, own_;
  StateIndex line_ = -1;  // pressure in the line behind the shuttle
  double rate_ = 0;       // 1/T
};

}  // namespace

ComponentType ls_shuttle_type() {
  return {.name = "ls_shuttle",
          .fields = kLsShuttleFields,
          .doc = "higher of two load-sensing pressures",
          .make_def = []() -> std::unique_ptr<ComponentDef> { return std::make_unique<LsShuttleDef>(); },
          .validate = nullptr,
          .build = [](const ComponentDef& def, CircuitBuilder& builder) -> std::unique_ptr<HydraulicComponent> {
            return std::make_unique<LsShuttle>(static_cast<const LsShuttleDef&>(def), builder);
          },
          .has_ls_port = true};
}

}  // namespace slew::hydraulics
