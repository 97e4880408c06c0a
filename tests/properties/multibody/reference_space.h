// SPDX-License-Identifier: Apache-2.0
// Vectors, turns and quaternions of space in long double, for the assembled reference: no code of libs/math.
#pragma once

#include <array>
#include <cmath>
#include <vector>

namespace slew::multibody::testing {

using Real = long double;

struct Vector3 {
  std::array<Real, 3> x{};

  Vector3() = default;
  Vector3(Real a, Real b, Real c) : x{a, b, c} {}
  explicit Vector3(const std::array<double, 3>& a) : x{a[0], a[1], a[2]} {}
  [[nodiscard]] static Vector3 unit(int axis) {
    return {static_cast<Real>(axis == 0), static_cast<Real>(axis == 1), static_cast<Real>(axis == 2)};
  }
  [[nodiscard]] Real operator[](std::size_t i) const { return x[i]; }
  Vector3& operator+=(const Vector3& b) {
    for (std::size_t i = 0; i < 3; ++i) x[i] += b.x[i];
    return *this;
  }
  Vector3& operator-=(const Vector3& b) {
    for (std::size_t i = 0; i < 3; ++i) x[i] -= b.x[i];
    return *this;
  }
};

[[nodiscard]] inline Vector3 operator+(Vector3 a, const Vector3& b) {
  return a += b;
}
[[nodiscard]] inline Vector3 operator-(Vector3 a, const Vector3& b) {
  return a -= b;
}
[[nodiscard]] inline Vector3 operator*(const Vector3& a, Real s) {
  return {a[0] * s, a[1] * s, a[2] * s};
}
[[nodiscard]] inline Vector3 operator*(Real s, const Vector3& a) {
  return a * s;
}
[[nodiscard]] inline Vector3 operator/(const Vector3& a, Real s) {
  return {a[0] / s, a[1] / s, a[2] / s};
}
[[nodiscard]] inline Vector3 operator-(const Vector3& a) {
  return a * -1;
}
[[nodiscard]] inline Real dot(const Vector3& a, const Vector3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
[[nodiscard]] inline Vector3 cross(const Vector3& a, const Vector3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
[[nodiscard]] inline Real norm(const Vector3& a) {
  return std::sqrt(dot(a, a));
}
[[nodiscard]] inline Vector3 normalized(const Vector3& a) {
  return a / norm(a);
}

struct Matrix3 {
  std::array<Vector3, 3> c{};  // columns

  [[nodiscard]] static Matrix3 diagonal(const Vector3& d) {
    return {{Vector3(d[0], 0, 0), Vector3(0, d[1], 0), Vector3(0, 0, d[2])}};
  }
  [[nodiscard]] static Matrix3 identity() { return diagonal({1, 1, 1}); }
  [[nodiscard]] const Vector3& col(std::size_t k) const { return c[k]; }
  [[nodiscard]] Real operator()(std::size_t row, std::size_t column) const { return c[column][row]; }
};

[[nodiscard]] inline Vector3 operator*(const Matrix3& A, const Vector3& b) {
  return A.c[0] * b[0] + A.c[1] * b[1] + A.c[2] * b[2];
}
[[nodiscard]] inline Matrix3 operator*(const Matrix3& A, const Matrix3& B) {
  return {{A * B.c[0], A * B.c[1], A * B.c[2]}};
}
[[nodiscard]] inline Matrix3 operator*(const Matrix3& A, Real s) {
  return {{A.c[0] * s, A.c[1] * s, A.c[2] * s}};
}
[[nodiscard]] inline Matrix3 operator/(const Matrix3& A, Real s) {
  return {{A.c[0] / s, A.c[1] / s, A.c[2] / s}};
}
[[nodiscard]] inline Matrix3 operator+(const Matrix3& A, const Matrix3& B) {
  return {{A.c[0] + B.c[0], A.c[1] + B.c[1], A.c[2] + B.c[2]}};
}
[[nodiscard]] inline Matrix3 operator-(const Matrix3& A, const Matrix3& B) {
  return {{A.c[0] - B.c[0], A.c[1] - B.c[1], A.c[2] - B.c[2]}};
}
[[nodiscard]] inline Matrix3 transpose(const Matrix3& A) {
  return {{Vector3(A(0, 0), A(0, 1), A(0, 2)), Vector3(A(1, 0), A(1, 1), A(1, 2)), Vector3(A(2, 0), A(2, 1), A(2, 2))}};
}
// a b^T
[[nodiscard]] inline Matrix3 outer(const Vector3& a, const Vector3& b) {
  return {{a * b[0], a * b[1], a * b[2]}};
}

// by the angle about a unit axis: R x = e (e . x) + cos (x - e (e . x)) + sin e x x
[[nodiscard]] inline Matrix3 turn_about(const Vector3& axis, Real angle) {
  const Real cosine = std::cos(angle), sine = std::sin(angle);
  Matrix3 R;
  for (int k = 0; k < 3; ++k) {
    const Vector3 x = Vector3::unit(k), along = axis * dot(axis, x);
    R.c[static_cast<std::size_t>(k)] = along + cosine * (x - along) + sine * cross(axis, x);
  }
  return R;
}

struct Quaternion {
  Real w = 1;
  Vector3 v;
};

[[nodiscard]] inline Quaternion operator*(const Quaternion& a, const Quaternion& b) {
  return {a.w * b.w - dot(a.v, b.v), a.w * b.v + b.w * a.v + cross(a.v, b.v)};
}

// of any length but zero: R x = x + 2 v x (v x x + w x) / |q|^2
[[nodiscard]] inline Matrix3 turn_of(const Quaternion& q) {
  const Real square = q.w * q.w + dot(q.v, q.v);
  Matrix3 R;
  for (int k = 0; k < 3; ++k) {
    const Vector3 x = Vector3::unit(k);
    R.c[static_cast<std::size_t>(k)] = x + cross(q.v, cross(q.v, x) + q.w * x) * (2 / square);
  }
  return R;
}

// A vector per speed.
using Columns = std::vector<Vector3>;

}  // namespace slew::multibody::testing
