// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/components/cylinder.h"

#include <algorithm>
#include <numbers>
#include <utility>

#include "hydraulics/end_cushion.h"

namespace slew::hydraulics {
namespace {

// a chamber squeezed beyond its stop keeps this part of its largest volume, so that the equations stay defined
constexpr double kSmallestChamber = 1e-3;

EndCushion cushion_of(const CushionParameters& cushion, double piston_diameter, double chamber_area) {
  if (cushion.length == 0) return {};
  constexpr double kCircle = 0.25 * std::numbers::pi;
  const double D = piston_diameter, d = cushion.plunger_diameter;
  EndCushion end{.length = cushion.length,
                 .entry_length = cushion.entry_length,
                 .area = d > 0 ? kCircle * (D * D - d * d) : chamber_area,
                 .has_check_valve = cushion.flow_back == CushionReturn::check_valve};
  for (const auto& [remaining, area] : cushion.areas) {
    end.throttle.push_back({remaining, cushion.discharge_coefficient * area});
  }
  if (cushion.areas.empty()) {
    const double bore = cushion.orifice_diameter;
    end.throttle.push_back({0, cushion.discharge_coefficient * kCircle * bore * bore});
  }
  return end;
}

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
                         .maximum_stroke = common.maximum_stroke,
                         .breakaway_friction = common.breakaway_friction,
                         .stribeck_speed = common.stribeck_speed},
          .coupling = common.coupling,
          .barrel = {std::min(0.0, common.minimum_stroke), std::max(common.piston_travel(), common.maximum_stroke)}};
}

void set_cushions(const CylinderParameters& common, ActuatorDef& actuator) {
  const double D = common.piston_diameter;
  actuator.line_force.minimum_cushion = cushion_of(common.cushion_a, D, actuator.area_a);
  actuator.line_force.maximum_cushion = cushion_of(common.cushion_b, D, actuator.area_b);
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
      ratio_(actuator.coordinate.ratio),
      cushion_a_(cushion_law(actuator.line_force.minimum_cushion, builder.def())),
      cushion_b_(cushion_law(actuator.line_force.maximum_cushion, builder.def())),
      minimum_stroke_(common.minimum_stroke),
      maximum_stroke_(common.maximum_stroke),
      pressure_floor_(builder.def().pressure_floor) {
  actuator_ = builder.add_actuator(name(), actuator);
  x_ = builder.position(actuator_);
  v_ = builder.speed(actuator_);
  const double span = common.piston_travel();
  const WallLaw wall{.factor = 0, .lowest = common.bulk_modulus, .highest = common.bulk_modulus};
  builder.add_content({.volume_index = a_,
                       .volume = common.dead_volume + common.dead_volume_a,
                       .slope = A_a_,
                       .position = x_,
                       .smallest = kSmallestChamber * A_a_ * span,
                       .wall = wall});
  builder.add_content({.volume_index = b_,
                       .volume = A_b_ * span + common.dead_volume + common.dead_volume_b,
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
  if (cushion_a_.exists()) variables.push_back(variable("cushion_pressure_a", Dimension::pressure));
  if (cushion_b_.exists()) variables.push_back(variable("cushion_pressure_b", Dimension::pressure));
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
  if (cushion_a_.exists()) *values++ = view[a_] + brake_a(view).drop;
  if (cushion_b_.exists()) *values++ = view[b_] + brake_b(view).drop;
  return values;
}

void Cylinder::add_passages(const CircuitView& view, Passages& passages) const noexcept {
  passages.move(a_, b_, leak(view));
  if (cushion_a_.exists()) passages.add_heat(a_, -brake_a(view).force * view[v_]);
  if (cushion_b_.exists()) passages.add_heat(b_, brake_b(view).force * view[v_]);
}

StateIndex Cylinder::first_cavitating(const CircuitView& view) const noexcept {
  if (cushion_a_.exists() && view[a_] + brake_a(view).drop < pressure_floor_) return a_;
  if (cushion_b_.exists() && view[b_] + brake_b(view).drop < pressure_floor_) return b_;
  return -1;
}

}  // namespace slew::hydraulics
