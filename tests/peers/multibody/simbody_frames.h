// SPDX-License-Identifier: Apache-2.0
// Vectors, rotations and masses of ours as Simbody's and back.
#pragma once

#include "math/rotation.h"
#include "tests/peers/multibody/simbody_headers.h"

namespace slew::multibody::testing {

inline SimTK::Vec3 to_peer(math::Vec3 a) {
  return {a[0], a[1], a[2]};
}

inline math::Vec3 from_peer(const SimTK::Vec3& a) {
  return {a[0], a[1], a[2]};
}

inline SimTK::Rotation to_peer(const math::Mat3& R) {
  // the constructor that takes the matrix as it is
  return {SimTK::Mat33(to_peer(R.c[0]), to_peer(R.c[1]), to_peer(R.c[2])), true};
}

inline SimTK::Transform to_peer(const math::Mat3& R, math::Vec3 p) {
  return {to_peer(R), to_peer(p)};
}

inline math::Mat3 from_peer(const SimTK::Rotation& R) {
  return {from_peer(SimTK::Vec3(R.asMat33().col(0))), from_peer(SimTK::Vec3(R.asMat33().col(1))),
          from_peer(SimTK::Vec3(R.asMat33().col(2)))};
}

inline SimTK::Body::Rigid rigid_body(double mass, math::Vec3 center, const math::Mat3& I) {
  const SimTK::Inertia central(I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2));
  return SimTK::Body::Rigid(
      SimTK::MassProperties(mass, to_peer(center), central.shiftFromMassCenter(to_peer(center), mass)));
}

}  // namespace slew::multibody::testing
