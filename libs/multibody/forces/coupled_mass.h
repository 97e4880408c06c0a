// SPDX-License-Identifier: Apache-2.0
// Forces that cylinder and piston on a line of force need at its two points. Internal to the library.
#pragma once

#include "multibody/model/state.h"

namespace slew::multibody {

struct PointForces {
  math::Vec3 F1, F2;  // N, Ground axes
};

// For accelerations a1, a2 of the points (less gravity); law in inertia.cpp, equations (1) to (3).
[[nodiscard]] PointForces point_forces(const CoupledMass& mass, const LineMotion& line, math::Vec3 a1,
                                       math::Vec3 a2) noexcept;

// Classical acceleration of a point of a link with u' = 0.
[[nodiscard]] inline math::Vec3 acceleration_at(const LinkMotion& link, math::Vec3 point) noexcept {
  const math::Vec3 s = point - link.p;
  return link.a + cross(link.alpha, s) + cross(link.w, cross(link.w, s));
}

}  // namespace slew::multibody
