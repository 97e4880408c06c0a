// SPDX-License-Identifier: Apache-2.0
// Definition and field tables of the shapes that give a body its inertia (shape_inertia.h).
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "contact/shape_properties.h"
#include "core/field.h"
#include "multibody/model/defs.h"

namespace slew::scene {

inline constexpr std::string_view kShapeKey = "shape", kPartsKey = "parts";

enum class AxisOfShape : int { x, y, z };

// A solid with its pose in the body and its mass or density.
struct PartDef {
  contact::SolidDef solid{};
  AxisOfShape axis = AxisOfShape::z;       // of cylinder, tube, cone (towards its top) and capsule
  Triple position{};                       // m, the shape's origin, body frame
  Triple orientation{};                    // rad, successive rotations z, x', z''
  double density = multibody::kUnlimited;  // kg/m3, > 0; infinite: from the mass, or the body's
  double mass = multibody::kUnlimited;     // kg, > 0; infinite: from the density
  bool hole = false;                       // the solid is taken away
};

// Keys beside `parts`, for all of them.
struct PartsDef {
  double density = multibody::kUnlimited;  // kg/m3, > 0: of parts without a density or mass of their own
  double mass = multibody::kUnlimited;     // kg, > 0: of all, spread evenly
};

// A value of `shape`, with the fields of a body and of a part that has it.
struct ShapeWord {
  std::string_view name, doc;
  std::vector<Field> body_fields, part_fields;
};

[[nodiscard]] std::span<const ShapeWord> shape_words();        // in the order of contact::SolidType
[[nodiscard]] std::span<const Field> parts_fields() noexcept;  // beside the list
[[nodiscard]] std::span<const Field> part_rows() noexcept;     // of a part, without its shape

// Every key that such a body may have beside those of any body.
[[nodiscard]] std::vector<std::string_view> keys_of_shapes();

}  // namespace slew::scene
