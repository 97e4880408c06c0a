// SPDX-License-Identifier: Apache-2.0
#include "multibody/forces/frame_pair.h"

#include <cmath>

namespace slew::multibody {
namespace {

using math::Mat3;
using math::Vec3;

struct RotationVector {
  Vec3 theta;
  double c = 0;
};

// from the half angle's sine s and cosine w, which keep their digits at small and at large angles
RotationVector rotation_vector(const Mat3& R) noexcept {
  constexpr double kSeriesLimit = 1e-3;  // what is left out is below the last bit
  const math::Quaternion q = math::quaternion_of(R);
  const Vec3 v(q.x, q.y, q.z);
  const double s = norm(v);
  if (s < kSeriesLimit) {
    const double s2 = s * s;
    return {v * (2 * (1 + s2 / 6 + 3 * s2 * s2 / 40)), 1.0 / 12 + s2 / 180};
  }
  const double half = std::atan2(s, q.w);
  return {v * (2 * half / s), (1 - half * q.w / s) / (4 * half * half)};
}

}  // namespace

Deflection deflection_of(const FramePair& pair, const LinkMotion& link1, const LinkMotion& link2) noexcept {
  Deflection d;
  const Vec3 s1 = link1.R * pair.p_L1, s2 = link2.R * pair.p_L2;
  d.R_W1 = link1.R * pair.R_L1;
  d.P2 = link2.p + s2;
  const Vec3 r = d.P2 - (link1.p + s1);
  const Vec3 v = (link2.v + cross(link2.w, s2)) - (link1.v + cross(link1.w, s1)) - cross(link1.w, r);
  const auto [theta, c] = rotation_vector(math::transpose(d.R_W1) * (link2.R * pair.R_L2));
  d.theta = theta;
  d.c = c;
  const Vec3 w = transpose_multiply(d.R_W1, link2.w - link1.w);
  const Vec3 turn = w - cross(theta, w) * 0.5 + cross(theta, cross(theta, w)) * c;
  const Vec3 shift = transpose_multiply(d.R_W1, r) - pair.rest, slide = transpose_multiply(d.R_W1, v);
  for (int k = 0; k < 3; ++k) {
    const auto i = static_cast<std::size_t>(k);
    d.x[i] = shift[k];
    d.x[i + 3] = theta[k];
    d.rate[i] = slide[k];
    d.rate[i + 3] = turn[k];
  }
  return d;
}

Vec3 moment_of(const Deflection& d, const Six& force) noexcept {
  const Vec3 m(force[3], force[4], force[5]);
  return m + cross(d.theta, m) * 0.5 + cross(d.theta, cross(d.theta, m)) * d.c;
}

PairMatrix matrix_of(const Deflection& d, const SixBySix& A) noexcept {
  const auto part = [&A](std::size_t row, std::size_t column) {
    Mat3 block;
    for (std::size_t c = 0; c < 3; ++c) {
      block.c[c] = Vec3(A[6 * row + column + c], A[6 * (row + 1) + column + c], A[6 * (row + 2) + column + c]);
    }
    return block;
  };
  const Mat3 theta = math::skew(d.theta);
  const Mat3 into = math::transpose(d.R_W1);
  const Mat3 turn = (Mat3::identity() - theta * 0.5 + theta * theta * d.c) * into;
  return {d.R_W1 * part(0, 0) * into, d.R_W1 * part(0, 3) * turn, math::transpose(turn) * part(3, 3) * turn};
}

WrenchPair wrenches_of(const Deflection& d, const Six& force, const LinkMotion& link1,
                       const LinkMotion& link2) noexcept {
  const Vec3 F = d.R_W1 * Vec3(force[0], force[1], force[2]);
  const Vec3 M = d.R_W1 * moment_of(d, force);
  return {wrench_at(d.P2, link1, -F, -M), wrench_at(d.P2, link2, F, M)};
}

}  // namespace slew::multibody
