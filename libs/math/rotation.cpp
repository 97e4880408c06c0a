// SPDX-License-Identifier: Apache-2.0
#include "math/rotation.h"

#include <math.h>  // sincos is not in <cmath>

namespace slew::math {

SinCos sin_cos(double angle) noexcept {
  SinCos result;
  ::sincos(angle, &result.sin, &result.cos);
  return result;
}

Quaternion operator*(const Quaternion& a, const Quaternion& b) noexcept {
  return {a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
          a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x, a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
}

Quaternion normalized(const Quaternion& q) noexcept {
  const double scale = 1 / std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
  return {q.w * scale, q.x * scale, q.y * scale, q.z * scale};
}

Mat3 rotation_of(const Quaternion& q) noexcept {
  const double s = 2 / (q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
  const double sx = s * q.x, sy = s * q.y, sz = s * q.z;
  const double xx = sx * q.x, yy = sy * q.y, zz = sz * q.z;
  const double xy = sx * q.y, xz = sx * q.z, yz = sy * q.z;
  const double wx = sx * q.w, wy = sy * q.w, wz = sz * q.w;
  return {Vec3(1 - (yy + zz), xy + wz, xz - wy), Vec3(xy - wz, 1 - (xx + zz), yz + wx),
          Vec3(xz + wy, yz - wx, 1 - (xx + yy))};
}

Quaternion quaternion_of(const Mat3& R) noexcept {
  const double trace = R(0, 0) + R(1, 1) + R(2, 2);
  // start from the largest of the four components
  const double t[4] = {trace, R(0, 0), R(1, 1), R(2, 2)};
  int largest = 0;
  for (int i = 1; i < 4; ++i) {
    if (t[i] > t[largest]) largest = i;
  }
  Quaternion q;
  if (largest == 0) {
    q = {1 + trace, R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1)};
  } else if (largest == 1) {
    q = {R(2, 1) - R(1, 2), 1 + 2 * R(0, 0) - trace, R(0, 1) + R(1, 0), R(0, 2) + R(2, 0)};
  } else if (largest == 2) {
    q = {R(0, 2) - R(2, 0), R(0, 1) + R(1, 0), 1 + 2 * R(1, 1) - trace, R(1, 2) + R(2, 1)};
  } else {
    q = {R(1, 0) - R(0, 1), R(0, 2) + R(2, 0), R(1, 2) + R(2, 1), 1 + 2 * R(2, 2) - trace};
  }
  if (q.w < 0) q = {-q.w, -q.x, -q.y, -q.z};
  return normalized(q);
}

Quaternion derivative(const Quaternion& q, Vec3 w_A) noexcept {
  return Quaternion{0, 0.5 * w_A[0], 0.5 * w_A[1], 0.5 * w_A[2]} * q;
}

Quaternion turn_by(Vec3 turn_A) noexcept {
  // limit of the square of half the angle, below which the series are exact to all digits
  constexpr double kSmall = 1e-3;
  const double z = 0.25 * dot(turn_A, turn_A);
  double ratio, cosine;  // sin(half)/half
  if (z < kSmall) {
    ratio = 1 - z * (1.0 / 6 - z * (1.0 / 120 - z / 5040));
    cosine = 1 - z * (0.5 - z * (1.0 / 24 - z * (1.0 / 720 - z / 40320)));
  } else {
    const double half = std::sqrt(z);
    const SinCos turn = sin_cos(half);
    ratio = turn.sin / half;
    cosine = turn.cos;
  }
  const Vec3 v = turn_A * (0.5 * ratio);
  return {cosine, v[0], v[1], v[2]};
}

Mat3 rotation_x(double angle) noexcept {
  const auto [s, c] = sin_cos(angle);
  return {Vec3(1, 0, 0), Vec3(0, c, s), Vec3(0, -s, c)};
}

Mat3 rotation_y(double angle) noexcept {
  const auto [s, c] = sin_cos(angle);
  return {Vec3(c, 0, -s), Vec3(0, 1, 0), Vec3(s, 0, c)};
}

Mat3 rotation_z(double angle) noexcept {
  const auto [s, c] = sin_cos(angle);
  return {Vec3(c, s, 0), Vec3(-s, c, 0), Vec3(0, 0, 1)};
}

Mat3 rotation_zxz(const std::array<double, 3>& angles) noexcept {
  return rotation_z(angles[0]) * rotation_x(angles[1]) * rotation_z(angles[2]);
}

Mat3 rotation_xyz(const std::array<double, 3>& angles) noexcept {
  return rotation_x(angles[0]) * rotation_y(angles[1]) * rotation_z(angles[2]);
}

double rotation_angle(const Mat3& R) noexcept {
  const Vec3 axial(R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1));
  return std::atan2(norm(axial), R(0, 0) + R(1, 1) + R(2, 2) - 1);
}

}  // namespace slew::math
