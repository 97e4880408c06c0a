// SPDX-License-Identifier: Apache-2.0
// Blocks of matrices over the six speeds of links: velocity of the origin, then angular velocity. Internal to the
// library.
#pragma once

#include <array>
#include <cstddef>

#include "multibody/model/state.h"

namespace slew::multibody {

inline constexpr std::size_t kLinkSpeeds = 6;

// Six by six, row-major.
using SpatialBlock = std::array<double, kLinkSpeeds * kLinkSpeeds>;

inline void add_to_block(const math::Mat3& a, std::size_t row, std::size_t column, SpatialBlock& block) noexcept {
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t c = 0; c < 3; ++c) block[(row + r) * kLinkSpeeds + column + c] += a.c[c][static_cast<int>(r)];
  }
}

// Inertia of a link about its origin.
[[nodiscard]] inline SpatialBlock inertia_block(const ArticulatedInertia& I) noexcept {
  SpatialBlock block{};
  add_to_block(I.M, 0, 0, block);
  add_to_block(I.K, 0, 3, block);
  add_to_block(transpose(I.K), 3, 0, block);
  add_to_block(I.J, 3, 3, block);
  return block;
}

// Mass A between a point at s_row from one link's origin and one at s_column from another's: X_row^T A X_column with
// X = [1  -s~].
[[nodiscard]] inline SpatialBlock point_mass_block(const math::Mat3& A, math::Vec3 s_row,
                                                   math::Vec3 s_column) noexcept {
  const math::Mat3 S_row = math::skew(s_row), S_column = math::skew(s_column);
  const math::Mat3 right = A * S_column;
  SpatialBlock block{};
  add_to_block(A, 0, 0, block);
  add_to_block(right * -1.0, 0, 3, block);
  add_to_block(S_row * A, 3, 0, block);
  add_to_block(S_row * right * -1.0, 3, 3, block);
  return block;
}

// A symmetric matrix over the velocity of a point and the angular velocity with which one link moves against another.
struct RelativeMatrix {
  math::Mat3 vv, vw, ww;
};

// Its block between two links, with the point at s_row and s_column from their origins:
// X_row^T A X_column with X = [1 -s~; 0 1]. For two different links it is negative.
[[nodiscard]] inline SpatialBlock relative_block(const RelativeMatrix& A, math::Vec3 s_row,
                                                 math::Vec3 s_column) noexcept {
  const math::Mat3 S_row = math::skew(s_row), S_column = math::skew(s_column), wv = transpose(A.vw);
  const math::Mat3 lower = S_row * A.vv + wv;
  SpatialBlock block{};
  add_to_block(A.vv, 0, 0, block);
  add_to_block(A.vw - A.vv * S_column, 0, 3, block);
  add_to_block(lower, 3, 0, block);
  add_to_block(S_row * A.vw + A.ww - lower * S_column, 3, 3, block);
  return block;
}

// Masses of a cylinder and piston between the two points of their line.
struct PointMasses {
  math::Mat3 A11, A12, A22;  // kg; A12 is symmetric
};

[[nodiscard]] inline PointMasses point_masses(const CoupledMass& mass, const CoupledMotion& m) noexcept {
  const math::Mat3 along = outer(m.e, m.e), across = math::Mat3::identity() - along;
  return {across * m.a11 + along * mass.m1, across * m.a12, across * m.a22 + along * mass.m2};
}

}  // namespace slew::multibody
