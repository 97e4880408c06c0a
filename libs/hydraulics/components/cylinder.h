// SPDX-License-Identifier: Apache-2.0
// The component behind all cylinder types: two chambers, the leak between them, and the port to the mechanics. The
// types differ in geometry only; equations in their headers.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "hydraulics/circuit_builder.h"
#include "hydraulics/component.h"
#include "hydraulics/components/cylinder_def.h"
#include "hydraulics/oil_properties.h"
#include "hydraulics/passages.h"
#include "math/cushion.h"

namespace slew::hydraulics {

class Cylinder final : public HydraulicComponent {
 public:
  // def: the component's own copy of its Def; common: the part of it that all cylinders have; actuator: its facts.
  Cylinder(std::unique_ptr<ComponentDef> def, const CylinderParameters& common, const ActuatorDef& actuator,
           CircuitBuilder& builder);

  void declare_dependencies(DependencyList& dependencies) const override;
  void add_rates(const CircuitView& view, Rates& rates) const noexcept override;
  void add_jacobian(const CircuitView& view, JacobianStamp& jacobian) const noexcept override;
  void list_variables(std::vector<ElementVariable>& variables) const override;
  double* read_variables(const CircuitView& view, double* values) const noexcept override;
  [[nodiscard]] void* def_address() noexcept override { return def_->address(); }
  void apply_parameters() noexcept override { G_leak_ = fluidity_ * common_.leak_flow / common_.leak_pressure; }
  void follow_oil(const PortOil& oil) noexcept override {
    fluidity_ = oil.fluidity(a_, b_);
    apply_parameters();
  }
  // what the piston sweeps does not leave the chambers; the throttle of a cushion heats the oil of its chamber
  void add_passages(const CircuitView& view, Passages& passages) const noexcept override;
  // A chamber whose cushion is drawn empty on the way out; -1: none.
  [[nodiscard]] StateIndex first_cavitating(const CircuitView& view) const noexcept override;

 private:
  // Pressures of the enclosed oil above those of the chambers [Pa].
  [[nodiscard]] math::CushionBrake brake_a(const CircuitView& view) const noexcept {
    return cushion_a_.at(view[x_] - minimum_stroke_, -view[v_]);
  }
  [[nodiscard]] math::CushionBrake brake_b(const CircuitView& view) const noexcept {
    return cushion_b_.at(maximum_stroke_ - view[x_], view[v_]);
  }
  [[nodiscard]] double leak(const CircuitView& view) const noexcept { return G_leak_ * (view[a_] - view[b_]); }

  std::unique_ptr<ComponentDef> def_;
  const CylinderParameters& common_;
  StateIndex a_, b_;
  double A_a_, A_b_;
  Motion motion_;
  double ratio_;  // m/rad when rotary
  int actuator_ = 0;
  StateIndex x_ = 0, v_ = 0;
  double G_leak_ = 0;    // m3/s/Pa
  double fluidity_ = 1;  // of the oil
  math::Cushion cushion_a_, cushion_b_;
  double minimum_stroke_, maximum_stroke_;  // m
  double pressure_floor_;                   // Pa
};

// The area of a full piston [m2].
[[nodiscard]] double piston_area(const CylinderParameters& common) noexcept;

// A linear actuator with a full piston on either side; the type's Def puts in what differs, then the cushions.
[[nodiscard]] ActuatorDef actuator_of(const CylinderParameters& common);
// Cushions of both chambers, whose areas the actuator has.
void set_cushions(const CylinderParameters& common, ActuatorDef& actuator);

// Def: the final Def of `component`, with a member `CylinderParameters common`.
template <typename Def>
[[nodiscard]] std::unique_ptr<HydraulicComponent> make_cylinder(const ComponentDef& component,
                                                                CircuitBuilder& builder) {
  auto def = std::make_unique<Def>(static_cast<const Def&>(component));
  const CylinderParameters& common = def->common;
  const ActuatorDef actuator = def->actuator().value();
  return std::make_unique<Cylinder>(std::move(def), common, actuator, builder);
}

}  // namespace slew::hydraulics
