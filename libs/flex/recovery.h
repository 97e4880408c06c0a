// SPDX-License-Identifier: Apache-2.0
// Stress of a flexible beam from its modal coordinates: matrices built once, evaluated without allocation.
//
// At both ends of every element, at the points of its section, with the strains of the shape functions
//   sigma = E (ux' - y rz' + z ry') = N/A + M_y z/Iyy - M_z y/Izz                                  (1)
//   tau = G J rx'/W_t                        where the torsion modulus W_t is known                 (2)
// linear in q. Shear stress of transverse forces is not covered, nor is stress by held modes: with few modes
// deflections are more accurate than stresses. Imported models have none.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "flex/fe_model.h"

namespace slew::flex {

struct StressPoint {
  int element = 0;         // counted from 1
  int node = 0;            // id of the node at the end
  double y = 0, z = 0;     // m, in the section
  bool has_shear = false;  // true if (2) is known
};

struct Recovery {
  std::size_t modes = 0;
  std::vector<StressPoint> points;
  std::vector<double> normal;  // points x modes, row-major [Pa/(m sqrt(kg))]
  std::vector<double> shear;   // points x modes; 0 if unknown
};

[[nodiscard]] Recovery make_recovery(const FeModel& model, const Eigen::MatrixXd& Phi);
// The same with some of the modes, as select() of reduced_body.h.
[[nodiscard]] Recovery select(const Recovery& recovery, std::span<const int> ordinals);

struct PointStress {
  double normal = 0, shear = 0;  // Pa
};
// Stress at a point. Size of q: modes. No allocation.
[[nodiscard]] PointStress stress_at(const Recovery& recovery, std::size_t point, std::span<const double> q) noexcept;

}  // namespace slew::flex
