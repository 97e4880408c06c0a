// Inertia of a body of the scene about its centre of mass. Internal to the library.
#pragma once

#include "math/rotation.h"
#include "multibody/defs.h"

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

// R I R^T: a tensor in other axes.
[[nodiscard]] inline math::Mat3 rotated(const math::Mat3& R, const math::Mat3& I) noexcept {
  return R * I * math::transpose(R);
}

}  // namespace slew::multibody
