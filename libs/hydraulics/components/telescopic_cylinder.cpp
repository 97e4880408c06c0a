// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/components/telescopic_cylinder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "hydraulics/circuit_builder.h"
#include "hydraulics/component.h"
#include "hydraulics/components/cylinder.h"
#include "hydraulics/components/cylinder_fields.h"
#include "hydraulics/components/cylinder_rules.h"
#include "hydraulics/oil_properties.h"
#include "hydraulics/passages.h"
#include "hydraulics/staged_area.h"

namespace slew::hydraulics {
namespace {

constexpr double kSmallestChamber = 1e-3;  // share of the largest content that a chamber keeps beyond its stop
constexpr double kSameStroke = 1e-6;       // m, of two numbers of six digits

constexpr auto kTelescopicCylinderFields = joined(
    cylinder_connection_fields<TelescopicCylinderDef>(),
    std::array{
        field<&TelescopicCylinderDef::stages>(
            "stages", {.dimension = Dimension::length,
                       .value_dimension = Dimension::length,
                       .range = kPositive,
                       .presence = Presence::required,
                       .doc = "[stroke at the end of a stage, diameter of its area], the largest first"}),
        field<&TelescopicCylinderDef::stage_transition>(
            "stage_transition", {.dimension = Dimension::length,
                                 .range = kPositive,
                                 .doc = "elastic way about the end of a stage, on which the next one takes over"}),
        field<&TelescopicCylinderDef::closed_length>("closed_length",
                                                     {.dimension = Dimension::length,
                                                      .range = kNotNegative,
                                                      .presence = Presence::required,
                                                      .doc = "length of the force element at stroke zero"}),
    },
    cylinder_stroke_fields<TelescopicCylinderDef>());

Table areas_of(const TelescopicCylinderDef& def) {
  Table areas;
  for (const auto& [end, diameter] : def.stages) {
    areas.push_back({end, 0.25 * std::numbers::pi * diameter * diameter});
  }
  return areas;
}

class TelescopicCylinder final : public HydraulicComponent {
 public:
  TelescopicCylinder(const TelescopicCylinderDef& def, CircuitBuilder& builder)
      : HydraulicComponent(def),
        def_(def),
        area_(areas_of(def), def.stage_transition),
        a_(builder.volume(def.common.port_a)),
        b_(builder.volume(def.common.port_b)),
        actuator_(builder.add_actuator(def.name, def.actuator().value())),
        x_(builder.position(actuator_)),
        v_(builder.speed(actuator_)) {
    builder.set_stages(actuator_, &area_);
    const double modulus = def.common.bulk_modulus;
    builder.add_content({.volume_index = a_,
                         .volume = def.common.dead_volume + def.common.dead_volume_a,
                         .slope = area_.largest(),
                         .position = x_,
                         .smallest = kSmallestChamber * area_.content_at(def.common.maximum_stroke),
                         .wall = {.factor = 0, .lowest = modulus, .highest = modulus},
                         .stages = &area_});
    apply_parameters();
  }

  void declare_dependencies(DependencyList& dependencies) const override {
    dependencies.add_restriction(a_, b_);
    dependencies.add(a_, x_), dependencies.add(b_, x_);
    dependencies.add(a_, v_), dependencies.add(b_, v_);
  }
  void add_rates(const CircuitView& view, Rates& rates) const noexcept override {
    const double swept = area_.area_at(view[x_]).value * view[v_];
    rates.move(a_, b_, leak(view));
    // an extending stage takes oil from A and pushes the air or oil out of B
    rates.add_flow(a_, -swept);
    rates.add_flow(b_, swept);
  }
  void add_jacobian(const CircuitView& view, JacobianStamp& jacobian) const noexcept override {
    const ValueSlope A = area_.area_at(view[x_]);
    jacobian.move(a_, b_, a_, G_leak_);
    jacobian.move(a_, b_, b_, -G_leak_);
    jacobian.move(a_, b_, v_, A.value);
    jacobian.move(a_, b_, x_, A.slope * view[v_]);
  }
  void list_variables(std::vector<ElementVariable>& variables) const override {
    variables.push_back(variable("stroke", Dimension::length));
    variables.push_back(variable("speed", Dimension::velocity));
    variables.push_back(variable("pressure_a", Dimension::pressure));
    variables.push_back(variable("pressure_b", Dimension::pressure));
    variables.push_back(variable("pressure_force", Dimension::force));
    variables.push_back(variable("force", Dimension::force));
    variables.push_back(variable("flow_a", Dimension::volume_flow));
    variables.push_back(variable("leak_flow", Dimension::volume_flow));
    variables.push_back(variable("stage", Dimension::none));
    variables.push_back(variable("area", Dimension::area));
  }
  double* read_variables(const CircuitView& view, double* values) const noexcept override {
    const double A = area_.area_at(view[x_]).value;
    *values++ = view[x_];
    *values++ = view[v_];
    *values++ = view[a_];
    *values++ = view[b_];
    *values++ = (view[a_] - view[b_]) * A;
    *values++ = view.line_force[actuator_];
    *values++ = A * view[v_];
    *values++ = leak(view);
    *values++ = area_.number_at(view[x_]);
    *values++ = A;
    return values;
  }
  // what the stages sweep does not leave the chamber
  void add_passages(const CircuitView& view, Passages& passages) const noexcept override {
    passages.move(a_, b_, leak(view));
  }
  void follow_oil(const PortOil& oil) noexcept override {
    fluidity_ = oil.fluidity(a_, b_);
    apply_parameters();
  }
  [[nodiscard]] void* def_address() noexcept override { return def_.address(); }
  void apply_parameters() noexcept override { G_leak_ = fluidity_ * def_.common.leak_flow / def_.common.leak_pressure; }

 private:
  [[nodiscard]] double leak(const CircuitView& view) const noexcept { return G_leak_ * (view[a_] - view[b_]); }

  TelescopicCylinderDef def_;
  StagedArea area_;
  StateIndex a_, b_;
  int actuator_;
  StateIndex x_, v_;
  double G_leak_ = 0;    // m3/s/Pa
  double fluidity_ = 1;  // of the oil
};

void check_stages(const TelescopicCylinderDef& def, Problems& errors) {
  const std::string key = def.name + ".stages";
  double begin = 0, before = 0;
  for (std::size_t i = 0; i < def.stages.size(); ++i) {
    const auto& [end, diameter] = def.stages[i];
    if (i > 0 && !(diameter < before)) {
      errors.push_back(
          {key,
           fmt::format("stage {} is not thinner than the one before: {:.4g} after {:.4g} m", i + 1, diameter, before),
           "diameters that fall from the first stage on", ""});
    }
    if (!(end - begin > def.stage_transition)) {
      errors.push_back({key,
                        fmt::format("stage {} is {:.4g} m long, and stage_transition {:.4g} m", i + 1, end - begin,
                                    def.stage_transition),
                        "strokes from 0 on that grow by more than stage_transition", ""});
    }
    begin = end, before = diameter;
  }
  if (std::fabs(begin - def.common.maximum_stroke) > kSameStroke) {
    errors.push_back(
        {def.name + ".maximum_stroke",
         fmt::format("the stages end at {:.4g} m, the stroke at {:.4g} m", begin, def.common.maximum_stroke),
         "the end of the last stage", ""});
  }
}

void validate_telescopic(const HydraulicsDef& circuit, const ComponentDef& component, Problems& errors,
                         Problems& warnings) {
  const TelescopicCylinderDef& def = static_cast<const TelescopicCylinderDef&>(component);
  check_open_side(circuit, def.name, def.common.port_b, errors);
  check_connections(circuit, def.name, def.common, errors, warnings);
  if (!check_stroke_order(def.name, def.common, errors) || def.stages.empty()) return;
  check_stages(def, errors);
  const double A = areas_of(def).front()[1];
  warn_of_creep(def.name, def.common, A, warnings);
  check_chamber(def.name, def.common, {'A', A, def.common.minimum_stroke, "minimum_stroke"}, A, errors);
}

}  // namespace

std::optional<ActuatorDef> TelescopicCylinderDef::actuator() const {
  ActuatorDef actuator = actuator_of(common);
  actuator.area_a = actuator.area_b = stages.empty() ? 0 : areas_of(*this).front()[1];
  actuator.has_stages = true;
  actuator.barrel = {std::min(0.0, common.minimum_stroke), common.maximum_stroke};
  actuator.coordinate.offset = -closed_length;
  return actuator;
}

ComponentType telescopic_cylinder_type() {
  return {.name = "telescopic_cylinder",
          .fields = kTelescopicCylinderFields,
          .doc = "single-acting telescopic cylinder of several stages on a translational force",
          .make_def = []() -> std::unique_ptr<ComponentDef> { return std::make_unique<TelescopicCylinderDef>(); },
          .validate = validate_telescopic,
          .build = [](const ComponentDef& def, CircuitBuilder& builder) -> std::unique_ptr<HydraulicComponent> {
            return std::make_unique<TelescopicCylinder>(static_cast<const TelescopicCylinderDef&>(def), builder);
          }};
}

}  // namespace slew::hydraulics
