// SPDX-License-Identifier: Apache-2.0
#include "math/euler_angles.h"

#include <cmath>

#include "math/rotation.h"

namespace slew::math {
namespace {

// below it, rounding decides the direction of the remaining axis
constexpr double kLocked = 1e-15;

double angle_about_z(const Mat3& R) noexcept {
  return std::atan2(R(1, 0), R(0, 0));
}

}  // namespace

std::array<double, 3> angles_zxz(const Mat3& R) noexcept {
  const double across = std::hypot(R(0, 2), R(1, 2));
  const double a = across < kLocked ? 0 : std::atan2(R(0, 2), -R(1, 2));
  const double b = std::atan2(across, R(2, 2));
  return {a, b, angle_about_z(transpose(rotation_z(a) * rotation_x(b)) * R)};
}

std::array<double, 3> angles_xyz(const Mat3& R) noexcept {
  const double across = std::hypot(R(1, 2), R(2, 2));
  const double a = across < kLocked ? 0 : std::atan2(-R(1, 2), R(2, 2));
  const double b = std::atan2(R(0, 2), across);
  return {a, b, angle_about_z(transpose(rotation_x(a) * rotation_y(b)) * R)};
}

}  // namespace slew::math
