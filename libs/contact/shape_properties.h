// SPDX-License-Identifier: Apache-2.0
// Volume, centre and inertia of simple solids, and of a body that consists of several.
//
// Own axes of a shape, origin in its middle: box by its edges along x, y, z; cylinder, tube, cone and capsule along z;
// hollow_box along x, open at both ends, its walls normal to y, its flanges normal to z. With V the volume and moments
// for the density 1, R the outer radius, L the length:
//   box          V = a b c                        Ixx = V (b^2 + c^2)/12, and so on                            (1)
//   hollow_box   the box of the outside less that of the inside
//   sphere       V = 4/3 pi R^3                   I = 2/5 V R^2                                                (2)
//   cylinder, tube (inner radius r, 0 for the cylinder)
//                V = pi (R^2 - r^2) L             Izz = V (R^2 + r^2)/2   Ixx = V (3 (R^2 + r^2) + L^2)/12     (3)
//   capsule      cylinder V1 = pi R^2 L between two half balls, together V2 = 4/3 pi R^3:
//                Izz = V1 R^2/2 + V2 2/5 R^2      Ixx = V1 (R^2/4 + L^2/12) + V2 (2/5 R^2 + L^2/4 + 3/8 L R)   (4)
//   cone         radius a at the base z = -L/2, b at the top, V = pi L/3 (a^2 + a b + b^2), centre above the base at
//                h = L/4 (a^2 + 2 a b + 3 b^2)/(a^2 + a b + b^2), Izz = pi L/10 (a^4 + a^3 b + a^2 b^2 + a b^3 + b^4),
//                Ixx = Izz/2 + pi L^3/30 (a^2 + 3 a b + 6 b^2) - V h^2                                         (5)
// Parts i of the masses m_i, centres c_i and tensors I_i, turned by R_i (parallel axes):
//   m = sum m_i     m c = sum m_i c_i     I = sum R_i I_i R_i^T + m_i (d^2 1 - d d^T),  d = c_i - c           (6)
// A hole is a part of negative mass and volume. Parts that overlap count twice.
// Source: Beer 2019.
#pragma once

#include <limits>
#include <span>

#include "contact/mass_properties.h"
#include "core/field.h"
#include "math/vector3.h"

namespace slew::contact {

enum class SolidType : int { box, hollow_box, sphere, cylinder, tube, cone, capsule };

// One struct for every solid; each type uses the members that its comment names.
struct SolidDef {
  SolidType type = SolidType::box;
  Triple size{};          // m, > 0: edges of a box
  double radius = 0;      // m, > 0: sphere, cylinder, capsule; of a cone at its base
  double top_radius = 0;  // m, >= 0: cone; 0: a point
  double length = 0;      // m, > 0: cylinder, tube, cone, hollow_box; capsule between the centres of its ends
  double diameter = 0;    // m, > 0: outside of a tube
  double width = 0;       // m, > 0: hollow_box along y, outside
  double height = 0;      // m, > 0: hollow_box along z, outside
  // infinite: not given
  double inner_diameter = std::numeric_limits<double>::infinity();  // m, > 0, < diameter: tube
  double wall = std::numeric_limits<double>::infinity();            // m, > 0, < width/2: hollow_box, normal to y
  double flange = std::numeric_limits<double>::infinity();          // m, > 0, < height/2: hollow_box, normal to z
};

// (1) to (5) for the density 1 kg/m3. Pre-condition: the ranges above.
[[nodiscard]] MassProperties shape_properties(const SolidDef& def) noexcept;

// Half the edges of the smallest box in the shape's axes about its origin that holds it [m].
[[nodiscard]] math::Vec3 half_extent(const SolidDef& def) noexcept;

// True if the point p [m, shape's axes] lies in the solid or at most `margin` [m] outside of a surface.
[[nodiscard]] bool is_inside(const SolidDef& def, math::Vec3 p, double margin) noexcept;

// A solid of a body.
struct PlacedSolid {
  SolidDef def;
  math::Vec3 p_BS;  // m, the shape's origin, body frame
  math::Mat3 R_BS = math::Mat3::identity();
  double density = 1;  // kg/m3, > 0; < 0: a hole
};

// (6), body axes; a hole counts negative in volume and mass. A body whose mass or volume is not above 0 has no centre:
// it is returned with centre and inertia 0.
[[nodiscard]] MassProperties sum_of(std::span<const PlacedSolid> parts) noexcept;

// Share of a hole's volume at which the body has a density below 0: outside of every part, or in a second hole. From
// 4096 points of a fixed sequence: 0 for a hole that fits, shares below 1/4096 may be missed.
[[nodiscard]] double share_without_material(std::span<const PlacedSolid> parts, std::size_t hole);

// Share of a part's volume that lies in earlier parts too and that no hole takes away there: it counts twice in sum_of.
// From points as above.
[[nodiscard]] double share_counted_twice(std::span<const PlacedSolid> parts, std::size_t part);

}  // namespace slew::contact
