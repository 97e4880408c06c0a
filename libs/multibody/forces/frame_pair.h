// SPDX-License-Identifier: Apache-2.0
// Deflection of a frame on one link against a frame on another, and the wrenches of a generalised force on it.
//
//   x = [d; theta],   d = R_1^T (P_2 - P_1) - d_0,   theta: rotation vector of R_12 = R_1^T R_2       (1)
//   d'     = R_1^T (v_P2 - v_P1 - w_1 x (P_2 - P_1))                                                  (2)
//   theta' = J^-1 w_12,   J^-1 = 1 - [theta]/2 + c [theta]^2,   c = (1 - |theta|/2 cot(|theta|/2))/|theta|^2   (3)
// with w_12 the angular velocity of frame 2 seen from frame 1, in frame 1's axes. A force Q = [F; m] that does the work
// Q . x' is, in frame 1's axes, the force F at P_2 of body 2 with the moment
//   M = J^-T m = m + theta x m/2 + c theta x (theta x m)                                              (4)
// and the opposite of both, at the same point P_2, on body 1. So forces and moments balance about any point, a motion
// of both bodies as one changes nothing, and a Q that comes of a potential V(x) keeps the energy at any rotation.
//
// The rotation vector is unique below half a turn, where it jumps: |theta| < pi. Source: Murray, Li and Sastry 1994,
// chapter 2 (exponential coordinates); (3) is the inverse of the left Jacobian of SO(3).
#pragma once

#include <array>

#include "multibody/forces/wrench.h"

namespace slew::multibody {

using Six = std::array<double, 6>;        // along x, y, z, then about them
using SixBySix = std::array<double, 36>;  // row by row

struct FramePair {
  int link1 = 0, link2 = 0;
  int body1 = 0, body2 = 0;
  math::Mat3 R_L1, R_L2;  // frames in their links
  math::Vec3 p_L1, p_L2;  // m, their origins
  math::Vec3 rest;        // d_0 [m], frame 1 axes
};

struct Deflection {
  Six x{};           // m, rad
  Six rate{};        // m/s, rad/s
  math::Mat3 R_W1;   // frame 1 in Ground
  math::Vec3 P2;     // m, Ground
  math::Vec3 theta;  // rad
  double c = 0;      // of (3) [1/rad2]
};

[[nodiscard]] Deflection deflection_of(const FramePair& pair, const LinkMotion& link1,
                                       const LinkMotion& link2) noexcept;

// Moment (4) on body 2 [N m], frame 1 axes.
[[nodiscard]] math::Vec3 moment_of(const Deflection& deflection, const Six& force) noexcept;

// force: Q [N, N m].
[[nodiscard]] WrenchPair wrenches_of(const Deflection& deflection, const Six& force, const LinkMotion& link1,
                                     const LinkMotion& link2) noexcept;

// A law's slopes A over x' as it is over the velocity of P_2 and the angular velocity of link 2 seen from link 1,
// Ground axes: J^T A J with J of (2) and (3).
struct PairMatrix {
  math::Mat3 vv, vw, ww;
};
[[nodiscard]] PairMatrix matrix_of(const Deflection& deflection, const SixBySix& A) noexcept;

}  // namespace slew::multibody
