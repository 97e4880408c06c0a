// SPDX-License-Identifier: Apache-2.0
// Rotations: matrices R_AB (columns are the axes of B in A), unit quaternions, Euler angles.
#pragma once

#include "math/vector3.h"

namespace slew::math {

struct SinCos {
  double sin, cos;
};

// Sine and cosine by one call of the C library, so that every build type runs the same code.
[[nodiscard]] SinCos sin_cos(double angle) noexcept;

// w + x i + y j + z k; its rotation does not depend on its length.
struct Quaternion {
  double w = 1, x = 0, y = 0, z = 0;
};

[[nodiscard]] Quaternion operator*(const Quaternion& a, const Quaternion& b) noexcept;
[[nodiscard]] Quaternion normalized(const Quaternion& q) noexcept;

// R_AB of q_AB; orthogonal for any length of q: R = 1 + 2 (w [v]x + [v]x [v]x) / |q|^2.
[[nodiscard]] Mat3 rotation_of(const Quaternion& q) noexcept;

// Unit quaternion of a rotation matrix, w >= 0 (Shepperd 1978).
[[nodiscard]] Quaternion quaternion_of(const Mat3& R) noexcept;

// dq_AB/dt = 1/2 (0, w) q for the angular velocity w of B seen from A, in A's axes [rad/s].
[[nodiscard]] Quaternion derivative(const Quaternion& q, Vec3 w_A) noexcept;

// Unit quaternion of a rotation by |turn_A| about turn_A [rad]: exp of half of it.
[[nodiscard]] Quaternion turn_by(Vec3 turn_A) noexcept;

[[nodiscard]] Mat3 rotation_x(double angle) noexcept;
[[nodiscard]] Mat3 rotation_y(double angle) noexcept;
[[nodiscard]] Mat3 rotation_z(double angle) noexcept;

// Successive rotations about z, x', z'' (a body's orientation) and about x, y', z'' (a joint frame's) [rad].
[[nodiscard]] Mat3 rotation_zxz(const std::array<double, 3>& angles) noexcept;
[[nodiscard]] Mat3 rotation_xyz(const std::array<double, 3>& angles) noexcept;

// Angle of the rotation R [rad, 0 .. pi].
[[nodiscard]] double rotation_angle(const Mat3& R) noexcept;

}  // namespace slew::math
