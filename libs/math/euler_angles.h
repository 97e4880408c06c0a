// SPDX-License-Identifier: Apache-2.0
// Euler angles of a rotation matrix: the inverses of rotation_zxz and rotation_xyz.
//
// The third angle is taken from the rotation that remains after the first two, so that the product of the three is R to
// rounding also where the first two are not unique (gimbal lock); the first is then 0.
#pragma once

#include <array>

#include "math/vector3.h"

namespace slew::math {

// R = Rz(a) Rx(b) Rz(c), b in [0, pi] [rad]. Pre-condition: R is a rotation.
[[nodiscard]] std::array<double, 3> angles_zxz(const Mat3& R) noexcept;

// R = Rx(a) Ry(b) Rz(c), b in [-pi/2, pi/2] [rad]. Pre-condition: R is a rotation.
[[nodiscard]] std::array<double, 3> angles_xyz(const Mat3& R) noexcept;

}  // namespace slew::math
