// SPDX-License-Identifier: Apache-2.0
// Vectors and matrices of three-dimensional space, four lanes wide so that one instruction handles a column.
//
// A Vec3 holds x, y, z and a fourth lane that stays zero. All operations are element by element in a fixed order, so
// the bits do not depend on the build type. The articulated-body recursion spends its time here.
#pragma once

#include <array>
#include <cmath>

namespace slew::math {

using Lanes = double __attribute__((vector_size(32)));

struct Vec3 {
  Lanes lanes{0, 0, 0, 0};

  constexpr Vec3() = default;
  constexpr explicit Vec3(Lanes l) : lanes(l) {}
  constexpr Vec3(double x, double y, double z) : lanes{x, y, z, 0} {}
  explicit Vec3(const std::array<double, 3>& a) : lanes{a[0], a[1], a[2], 0} {}

  [[nodiscard]] double operator[](int i) const noexcept { return lanes[i]; }
  [[nodiscard]] double x() const noexcept { return lanes[0]; }
  [[nodiscard]] double y() const noexcept { return lanes[1]; }
  [[nodiscard]] double z() const noexcept { return lanes[2]; }
  [[nodiscard]] std::array<double, 3> array() const noexcept { return {lanes[0], lanes[1], lanes[2]}; }

  Vec3& operator+=(Vec3 b) noexcept {
    lanes += b.lanes;
    return *this;
  }
  Vec3& operator-=(Vec3 b) noexcept {
    lanes -= b.lanes;
    return *this;
  }
};

[[nodiscard]] inline Vec3 operator+(Vec3 a, Vec3 b) noexcept {
  return Vec3(a.lanes + b.lanes);
}
[[nodiscard]] inline Vec3 operator-(Vec3 a, Vec3 b) noexcept {
  return Vec3(a.lanes - b.lanes);
}
[[nodiscard]] inline Vec3 operator-(Vec3 a) noexcept {
  return Vec3(-a.lanes);
}
[[nodiscard]] inline Vec3 operator*(Vec3 a, double s) noexcept {
  return Vec3(a.lanes * s);
}
[[nodiscard]] inline Vec3 operator*(double s, Vec3 a) noexcept {
  return Vec3(a.lanes * s);
}

[[nodiscard]] inline double dot(Vec3 a, Vec3 b) noexcept {
  const Lanes p = a.lanes * b.lanes;
  return (p[0] + p[1]) + p[2];
}

[[nodiscard]] inline Vec3 cross(Vec3 a, Vec3 b) noexcept {
  const Lanes a_yzx = __builtin_shufflevector(a.lanes, a.lanes, 1, 2, 0, 3);
  const Lanes b_yzx = __builtin_shufflevector(b.lanes, b.lanes, 1, 2, 0, 3);
  const Lanes zxy = a.lanes * b_yzx - a_yzx * b.lanes;
  return Vec3(__builtin_shufflevector(zxy, zxy, 1, 2, 0, 3));
}

[[nodiscard]] inline double norm(Vec3 a) noexcept {
  return std::sqrt(dot(a, a));
}

template <int I>
[[nodiscard]] inline Lanes broadcast(Vec3 a) noexcept {
  return __builtin_shufflevector(a.lanes, a.lanes, I, I, I, I);
}

// a b + c and c - a b with one rounding, on every machine and in every build
[[nodiscard]] inline Lanes multiply_add(Lanes a, Lanes b, Lanes c) noexcept {
#ifdef __FMA__
  return __builtin_ia32_vfmaddpd256(a, b, c);
#else
  return Lanes{std::fma(a[0], b[0], c[0]), std::fma(a[1], b[1], c[1]), std::fma(a[2], b[2], c[2]),
               std::fma(a[3], b[3], c[3])};
#endif
}
[[nodiscard]] inline Lanes subtract_product(Lanes c, Lanes a, Lanes b) noexcept {
  return multiply_add(-a, b, c);
}

// 3 x 3 matrix as three columns. Copies go column by column: the compiler would copy the whole by halves of a column,
// and reading a column back then waits for both halves.
struct Mat3 {
  Vec3 c[3];

  constexpr Mat3() = default;
  constexpr Mat3(Vec3 c0, Vec3 c1, Vec3 c2) : c{c0, c1, c2} {}
  constexpr Mat3(const Mat3& b) : c{b.c[0], b.c[1], b.c[2]} {}
  constexpr Mat3& operator=(const Mat3& b) noexcept {
    c[0] = b.c[0];
    c[1] = b.c[1];
    c[2] = b.c[2];
    return *this;
  }

  [[nodiscard]] static Mat3 identity() noexcept { return diagonal(1, 1, 1); }
  [[nodiscard]] static Mat3 diagonal(double a, double b, double d) noexcept {
    return {Vec3(a, 0, 0), Vec3(0, b, 0), Vec3(0, 0, d)};
  }
  [[nodiscard]] double operator()(int row, int column) const noexcept { return c[column][row]; }

  Mat3& operator+=(const Mat3& b) noexcept {
    c[0] += b.c[0];
    c[1] += b.c[1];
    c[2] += b.c[2];
    return *this;
  }
  Mat3& operator-=(const Mat3& b) noexcept {
    c[0] -= b.c[0];
    c[1] -= b.c[1];
    c[2] -= b.c[2];
    return *this;
  }
};

[[nodiscard]] inline Mat3 operator+(const Mat3& a, const Mat3& b) noexcept {
  return {a.c[0] + b.c[0], a.c[1] + b.c[1], a.c[2] + b.c[2]};
}
[[nodiscard]] inline Mat3 operator-(const Mat3& a, const Mat3& b) noexcept {
  return {a.c[0] - b.c[0], a.c[1] - b.c[1], a.c[2] - b.c[2]};
}
[[nodiscard]] inline Mat3 operator*(const Mat3& a, double s) noexcept {
  return {a.c[0] * s, a.c[1] * s, a.c[2] * s};
}

[[nodiscard]] inline Vec3 operator*(const Mat3& a, Vec3 b) noexcept {
  const Lanes first = a.c[0].lanes * broadcast<0>(b);
  return Vec3(multiply_add(a.c[2].lanes, broadcast<2>(b), multiply_add(a.c[1].lanes, broadcast<1>(b), first)));
}

[[nodiscard]] inline Mat3 operator*(const Mat3& a, const Mat3& b) noexcept {
  return {a * b.c[0], a * b.c[1], a * b.c[2]};
}

[[nodiscard]] inline Mat3 transpose(const Mat3& a) noexcept {
  const Lanes low = __builtin_shufflevector(a.c[0].lanes, a.c[1].lanes, 0, 4, 2, 6);   // a00 a01 a20 a21
  const Lanes high = __builtin_shufflevector(a.c[0].lanes, a.c[1].lanes, 1, 5, 3, 7);  // a10 a11 0 0
  const Lanes third = a.c[2].lanes;                                                    // a02 a12 a22 0
  return {Vec3(__builtin_shufflevector(low, third, 0, 1, 4, 7)), Vec3(__builtin_shufflevector(high, third, 0, 1, 5, 7)),
          Vec3(__builtin_shufflevector(low, third, 2, 3, 6, 7))};
}

// transpose(a) b without forming the transpose
[[nodiscard]] inline Vec3 transpose_multiply(const Mat3& a, Vec3 b) noexcept {
  return {dot(a.c[0], b), dot(a.c[1], b), dot(a.c[2], b)};
}

// a b^T
[[nodiscard]] inline Mat3 outer(Vec3 a, Vec3 b) noexcept {
  return {Vec3(a.lanes * broadcast<0>(b)), Vec3(a.lanes * broadcast<1>(b)), Vec3(a.lanes * broadcast<2>(b))};
}

// [a]x: skew(a) b = a x b
[[nodiscard]] inline Mat3 skew(Vec3 a) noexcept {
  return {Vec3(0, a[2], -a[1]), Vec3(-a[2], 0, a[0]), Vec3(a[1], -a[0], 0)};
}

// a skew(r)
[[nodiscard]] inline Mat3 times_skew(const Mat3& a, Vec3 r) noexcept {
  const Lanes x = broadcast<0>(r), y = broadcast<1>(r), z = broadcast<2>(r);
  return {Vec3(a.c[1].lanes * z - a.c[2].lanes * y), Vec3(a.c[2].lanes * x - a.c[0].lanes * z),
          Vec3(a.c[0].lanes * y - a.c[1].lanes * x)};
}

// Inverse of a symmetric matrix by cofactors. Pre-condition: positive definite.
[[nodiscard]] inline Mat3 inverse_symmetric(const Mat3& a) noexcept {
  const Vec3 c0 = cross(a.c[1], a.c[2]), c1 = cross(a.c[2], a.c[0]), c2 = cross(a.c[0], a.c[1]);
  const double scale = 1 / dot(a.c[0], c0);
  return {c0 * scale, c1 * scale, c2 * scale};
}

// Eigenvalues of a symmetric matrix in ascending order (Jacobi rotations; for checks at load).
[[nodiscard]] std::array<double, 3> symmetric_eigenvalues(const Mat3& a) noexcept;

}  // namespace slew::math
