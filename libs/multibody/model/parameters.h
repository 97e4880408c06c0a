// SPDX-License-Identifier: Apache-2.0
// Parameters that may change between two steps. Finding and setting one does not allocate.
//
//   "Bag.mass"                     body: inertia scales with the mass, the centre of mass stays
//   "ForceT_Lift.damping_constant" the live fields of force elements
//   "Body_Pillar.viscous_friction", "Cross.limit_damping_2"  friction and limit constants of joints that have a row
//   "mechanics.gravity.x" (y, z)   gravity
//   "Mount.stiffness.x"            the live fields of the other elements (forces/element_set.h)
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "multibody/model/model.h"

namespace slew::multibody {

enum class ParameterKind : std::uint8_t {
  body_mass,
  line_law,
  angle_law,
  joint_law,
  gravity,
  force  // and all above: kinds of force elements, in the order of their table
};

// Whether it is a value of a force kind whose law is linear around a pose (ForceRow::kIsLinear).
[[nodiscard]] bool is_linear_force(ParameterKind kind) noexcept;

struct Parameter {
  ParameterKind kind = ParameterKind::body_mass;
  int element = 0;  // body, element, row; axis of gravity
  int member = 0;   // member of a law
};

// Empty if the path names no live parameter of the mechanism.
[[nodiscard]] std::optional<Parameter> find_parameter(const Model& model, std::string_view path) noexcept;

// True if the model has the parameter of an external number.
[[nodiscard]] bool has_parameter(const Model& model, Parameter parameter) noexcept;

// Number of parameters.
[[nodiscard]] std::size_t parameter_count(const Model& model) noexcept;

[[nodiscard]] double get_parameter(const Model& model, Parameter parameter) noexcept;

// SI value, in the range of its field; merged bodies and the elements' use are updated.
void set_parameter(Model& model, Parameter parameter, double value) noexcept;

// kg, > 0. body: index in the model.
void set_body_mass(Model& model, int body, double mass) noexcept;

}  // namespace slew::multibody
