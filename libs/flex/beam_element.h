// SPDX-License-Identifier: Apache-2.0
// One straight beam element between two nodes, with shear deformation, in the axes of the body frame.
//
// Local axes: x from node 1 to node 2, y and z the section's. With xi = x/l and the shear numbers
//   phi_y = 12 E Izz/(k_y G A l^2),   phi_z = 12 E Iyy/(k_z G A l^2)             (0 where k is 0)            (1)
// the displacements inside follow from the nodes' by the static solution without load between them. In the x-y plane:
//   (1+phi) v = [1 - 3 xi^2 + 2 xi^3 + phi (1-xi)] v1 + l [xi - 2 xi^2 + xi^3 + phi/2 (xi-xi^2)] rz1
//             + [3 xi^2 - 2 xi^3 + phi xi] v2         + l [-xi^2 + xi^3 - phi/2 (xi-xi^2)] rz2               (2)
//   (1+phi) rz = 6/l (xi^2-xi) v1 + [1 - 4 xi + 3 xi^2 + phi (1-xi)] rz1
//              + 6/l (xi-xi^2) v2 + [-2 xi + 3 xi^2 + phi xi] rz2                                             (3)
// with phi_y; in the x-z plane the same for w and -ry with phi_z; ux and rx are linear. Six internal freedoms add
// 4 xi (1-xi) times themselves to ux, v, w, rx, ry, rz: without them shear, stretch and twist are constant along the
// element, and its frequencies of second order only. The planes' four are there with shear deformation. A point (y, z)
// of a section moves by
//   (ux - y rz + z ry,  v - z rx,  w + y rx)                                                                  (4)
// K is the integral of E A ux'^2 + G J rx'^2 + E Izz rz'^2 + E Iyy ry'^2 + k G A gamma^2: thesis eq. 29 at the far end,
// and diagonal in the internal freedoms, since the other fields need no load inside.
// Source: Przemieniecki 1968, ch. 5 and 11; the flexible-body tutorial thesis (2017), eq. 29, signs and phi corrected.
// Deviation: the internal freedoms.
// Not covered: warping, sections whose shear centre is not the centroid, taper inside one element.
// Card: docs/models/flex_beam_elements.md.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "flex/section.h"
#include "math/vector3.h"

namespace slew::flex {

inline constexpr int kNodalFreedoms = 12, kElementFreedoms = 18;  // nodal: in body axes; internal: in local axes
using Matrix3xElement = Eigen::Matrix<double, 3, kElementFreedoms>;
using ElementMatrix = Eigen::Matrix<double, kElementFreedoms, kElementFreedoms>;
using ElementRow = Eigen::Matrix<double, 1, kElementFreedoms>;
using ElementFreedoms = std::array<int, kElementFreedoms>;

struct BeamElement {
  int id = 0;  // counted from 1
  std::size_t node1 = 0, node2 = 0;
  ElementFreedoms freedoms{};   // rows of the model: six of node 1, six of node 2, internal; -1: none
  math::Vec3 start;             // position of node 1 [m]
  math::Mat3 axes;              // columns: local x, y, z
  double length = 0;            // l [m]
  double youngs_modulus = 0;    // E [Pa]
  double shear_modulus = 0;     // G [Pa]
  double density = 0;           // rho [kg/m3]
  double phi_y = 0, phi_z = 0;  // (1)
  Section section;
};

// (1) for bending stiffness E I against shear k G A; 0 without shear deformation.
[[nodiscard]] double shear_number(double bending, double shear_factor, double shear_modulus, double area,
                                  double length) noexcept;

// N(P) = axis + y per_y + z per_z: displacement in body axes per freedom of the element.
struct ElementField {
  Matrix3xElement axis, per_y, per_z;
};

// Rotary inertia: whether sections that turn in bending move their points along the beam.
enum class RotaryInertia : int { with, none };

// The element's internal freedoms, of six possible ones.
[[nodiscard]] std::array<bool, 6> internal_freedoms(const BeamElement& element, RotaryInertia rotary) noexcept;

[[nodiscard]] ElementField field_at(const BeamElement& element, double xi, RotaryInertia rotary = RotaryInertia::with);
// d(axis)/dx across the element's axis: (0, v', w') turned into body axes [1 per freedom].
[[nodiscard]] Matrix3xElement slope_at(const BeamElement& element, double xi);

// Strain of the axis ux' [1], rate of twist rx', curvatures ry' and rz' [1/m] per freedom.
struct ElementStrain {
  ElementRow stretch, twist, bend_y, bend_z;
};
[[nodiscard]] ElementStrain strain_at(const BeamElement& element, double xi);

// Symmetric to the bit.
[[nodiscard]] ElementMatrix stiffness_of(const BeamElement& element);

}  // namespace slew::flex
