// SPDX-License-Identifier: Apache-2.0
// A beam's elements as numbers by length, for finite segments (finite_segments.h).
#pragma once

#include <vector>

#include "flex/fe_model.h"

namespace slew::flex {

// One straight element, the same along its length. y: direction of the section's y axis, a unit vector across it.
struct UniformElement {
  int node1 = 0, node2 = 0;  // ids
  double axial = 0;          // E A [N]
  double torsion = 0;        // G J [N m2]
  double bend_y = 0;         // E Iyy [N m2]: in the x-z plane
  double bend_z = 0;         // E Izz [N m2]
  double shear_y = 0;        // k_y G A [N]; 0: rigid in shear
  double shear_z = 0;        // k_z G A [N]
  double mass = 0;           // rho A [kg/m]
  double rotary_y = 0;       // rho Iyy [kg m]
  double rotary_z = 0;       // rho Izz [kg m]
  math::Vec3 y;              // body axes
};

// The elements of a beam; none for imported matrices.
[[nodiscard]] std::vector<UniformElement> uniform_elements(const FeModel& model);

}  // namespace slew::flex
