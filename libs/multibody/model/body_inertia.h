// SPDX-License-Identifier: Apache-2.0
// Inertia of a body of the scene about its centre of mass, and its validity.
#pragma once

#include <algorithm>
#include <cmath>

#include "math/rotation.h"
#include "multibody/model/defs.h"

namespace slew::multibody {

// Body axes [kg m2].
[[nodiscard]] inline math::Mat3 inertia_about_center(const BodyDef& def) noexcept {
  const auto [xx, yy, zz] = def.inertia;
  const auto [xy, xz, yz] = def.products;
  math::Mat3 I{math::Vec3(xx, xy, xz), math::Vec3(xy, yy, yz), math::Vec3(xz, yz, zz)};
  if (def.inertia_about == InertiaPoint::body_origin) {
    const math::Mat3 c = math::skew(math::Vec3(def.center_of_mass));
    I += (c * c) * def.mass;
  }
  return I;
}

// printed inertias are rounded: share of the largest moment by which a rule may fail
inline constexpr double kInertiaTolerance = 1e-6;

// True if a body can have this tensor about its centre of mass: no principal moment below zero or larger than the sum
// of the other two.
[[nodiscard]] inline bool is_inertia(const math::Mat3& tensor) noexcept {
  const auto [a, b, c] = math::symmetric_eigenvalues(tensor);
  const double tolerance = kInertiaTolerance * std::max({tensor(0, 0), tensor(1, 1), tensor(2, 2), std::abs(c)});
  return a >= -tolerance && a + b >= c - tolerance;
}

// R I R^T: a tensor in other axes.
[[nodiscard]] inline math::Mat3 rotated(const math::Mat3& R, const math::Mat3& I) noexcept {
  return R * I * math::transpose(R);
}

}  // namespace slew::multibody
