// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/components/cylinder.h"

#include <numbers>
#include <utility>

namespace slew::hydraulics {
namespace {

// a chamber squeezed beyond its stop keeps this part of its largest volume, so that the equations stay defined
constexpr double kSmallestChamber = 1e-3;

}  // namespace

double piston_area(const CylinderParameters& common) noexcept {
  return 0.25 * std::numbers::pi * common.piston_diameter * common.piston_diameter;
}

ActuatorDef actuator_of(const CylinderParameters& common) {
  return {.force = common.force,
          .port_a = common.port_a,
          .port_b = common.port_b,
          .area_a = piston_area(common),
          .area_b = piston_area(common),
          .line_force = {.friction_curve = common.friction_curve,
                         .cylinder_coefficient = common.cylinder_coefficient,
                         .seal_friction = common.seal_friction,
                         .viscous_friction = common.viscous_friction,
                         .end_stiffness = common.end_stiffness,
                         .end_damping = common.end_damping,
                         .minimum_stroke = common.minimum_stroke,
                         .maximum_stroke = common.maximum_stroke},
          .coupling = common.coupling};
}

Cylinder::Cylinder(std::unique_ptr<ComponentDef> def, const CylinderParameters& common, const ActuatorDef& actuator,
                   CircuitBuilder& builder)
    : HydraulicComponent(*def),
      def_(std::move(def)),
      common_(common),
      a_(builder.volume(common.port_a)),
      b_(builder.volume(common.port_b)),
      A_a_(actuator.area_a),
      A_b_(actuator.area_b),
      motion_(actuator.motion),
      ratio_(actuator.coordinate.ratio) {
  actuator_ = builder.add_actuator(name(), actuator);
  x_ = builder.position(actuator_);
  v_ = builder.speed(actuator_);
  const double span = common.piston_travel();
  const WallLaw wall{.factor = 0, .lowest = common.bulk_modulus, .highest = common.bulk_modulus};
  builder.add_content({.volume_index = a_,
                       .volume = common.dead_volume,
                       .slope = A_a_,
                       .position = x_,
                       .smallest = kSmallestChamber * A_a_ * span,
                       .wall = wall});
  builder.add_content({.volume_index = b_,
                       .volume = A_b_ * span + common.dead_volume,
                       .slope = -A_b_,
                       .position = x_,
                       .smallest = kSmallestChamber * A_b_ * span,
                       .wall = wall});
  Cylinder::apply_parameters();
}

void Cylinder::declare_dependencies(DependencyList& dependencies) const {
  dependencies.add_restriction(a_, b_);
  dependencies.add(a_, v_);
  dependencies.add(b_, v_);
}

void Cylinder::add_rates(const CircuitView& view, Rates& rates) const noexcept {
  const double v = view[v_];
  rates.move(a_, b_, leak(view));
  // an extending piston takes oil from A and pushes oil out of B
  rates.add_flow(a_, -v * A_a_);
  rates.add_flow(b_, v * A_b_);
}

void Cylinder::add_jacobian(const CircuitView&, JacobianStamp& jacobian) const noexcept {
  jacobian.move(a_, b_, a_, G_leak_);
  jacobian.move(a_, b_, b_, -G_leak_);
  jacobian.add(a_, v_, -A_a_);
  jacobian.add(b_, v_, A_b_);
}

void Cylinder::list_variables(std::vector<ElementVariable>& variables) const {
  variables.push_back(variable("stroke", Dimension::length));
  variables.push_back(variable("speed", Dimension::velocity));
  variables.push_back(variable("pressure_a", Dimension::pressure));
  variables.push_back(variable("pressure_b", Dimension::pressure));
  variables.push_back(variable("pressure_force", Dimension::force));
  variables.push_back(variable("force", Dimension::force));
  if (motion_ == Motion::rotary) variables.push_back(variable("torque", Dimension::torque));
  variables.push_back(variable("flow_a", Dimension::volume_flow));
  variables.push_back(variable("flow_b", Dimension::volume_flow));
  variables.push_back(variable("leak_flow", Dimension::volume_flow));
}

double* Cylinder::read_variables(const CircuitView& view, double* values) const noexcept {
  const double v = view[v_], line_force = view.line_force[actuator_];
  *values++ = view[x_];
  *values++ = v;
  *values++ = view[a_];
  *values++ = view[b_];
  *values++ = view[a_] * A_a_ - view[b_] * A_b_;
  *values++ = line_force;
  if (motion_ == Motion::rotary) *values++ = ratio_ * line_force;
  // into the chambers
  *values++ = v * A_a_;
  *values++ = -v * A_b_;
  *values++ = leak(view);
  return values;
}

}  // namespace slew::hydraulics
