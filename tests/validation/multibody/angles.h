// SPDX-License-Identifier: Apache-2.0
// Angles of given rotations, as scenes write them.
#pragma once

#include <cmath>

#include "core/field.h"
#include "math/rotation.h"

namespace slew::multibody::testing {

// A body's orientation: successive z, x', z'' [rad].
inline Triple angles_zxz(const math::Mat3& R) {
  const double theta = std::acos(std::fmin(1, std::fmax(-1, R(2, 2))));
  if (std::fabs(R(2, 2)) > 1 - 1e-15) return {std::atan2(R(1, 0), R(0, 0)), theta, 0};
  return {std::atan2(R(0, 2), -R(1, 2)), theta, std::atan2(R(2, 0), R(2, 1))};
}

// A joint frame's orientation: successive x, y', z'' [rad].
inline Triple angles_xyz(const math::Mat3& R) {
  return {std::atan2(-R(1, 2), R(2, 2)), std::asin(std::fmin(1, std::fmax(-1, R(0, 2)))),
          std::atan2(-R(0, 1), R(0, 0))};
}

}  // namespace slew::multibody::testing
