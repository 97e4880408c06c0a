// SPDX-License-Identifier: Apache-2.0
// Cylinder and piston on a line of force (CoupledMass) of which an end rides on modes, in the recursion. Internal to
// the library.
//
// Their quadratic form in the velocities of both points is exact: with x_B further from Ground than x_A,
//   T = 1/2 x_B^T A_BB x_B + x_B^T A_AB x_A + 1/2 x_A^T A_AA x_A                                        (1)
// The first and the last term are a mass at a point of one link, node or frame, and join the link's inertia before the
// recursion begins. The remaining term couples x_B with z = x_A, a point of a body nearer to Ground. A lies on the body
// that carries the joint of B's (frame F, speeds V_F, u_F of its modes), B on the body that the joint moves (link C,
// modes u_C):
//   z = J V_F + sum_k y_k u_Fk,   y_k = Phi_k + Psi_k x s_A,   J = [1, -(P_A - p_F)~]                    (2)
// For C, z is one more input of its modes and its joint, like the motion of the parent. Columns for z of the wrench on
// C and of the forces on u_C:
//   p = (s_B~, 1) A_AB,   r_k = A_AB (Phi_k + Psi_k x s_B)     (no r where B is on the frame itself)    (3)
// and as modes and joint are eliminated, with E, B, U, S, D of flexible_part.h and articulated.cpp,
//   E = C C^T,  X = C^-1 r,  p <- p - B C^-T X,  Z_ij -= X_i^T X_j,  h += X^T C^-1 residual_C           (4)
//   R = S^T p,   p <- p - U D^-1 R,  Z_ij -= R_i^T D^-1 R_j,  h += R^T D^-1 residual_q                  (5)
// i and j are dummies across the same joint. p acts on the link P that carries the joint, the frame F or another node
// of it: with the columns p_F about F and g_k = p^T (Psi_k, Phi_k) of P along its modes, T gains
//   sum_i z_i^T (p_F^T V_F + g_k u_Fk)_i + 1/2 sum_ij z_i^T Z_ij z_j                                    (6)
// by which J, K, M of F, its B and its E grow, and h is one more bias force at A. Going out again,
//   u'_q -= D^-1 R z',   u'_C -= C^-T X z'                                                                   (7)
// C may itself be a node of F at which another flexible body is fixed, whose node B is: then (5) falls away and p acts
// on that node. Between points on one body there is nothing to eliminate: (6) with P the link of B. All of it is
// O(modes^2) a dummy.
//
// Not covered: points with more than one joint between their bodies, and points or joints at nodes of two bodies that
// are fixed to each other (their modes would couple without either's frame): refused by start_rules.h.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "math/rotation.h"

namespace slew::multibody {

struct Model;
struct Workspace;

struct NodeDummy {
  int mass = 0;         // Model::coupled
  int child = 0;        // C; 0: both points are on one body, or A is on Ground
  int outer = 0;        // link of B
  int inner = 0;        // link of A
  int carrier = 0;      // P
  int frame = 0;        // F
  int outer_part = -1;  // Model::parts of C that B rides on
  int inner_part = -1;  // of F that A or P ride on
  bool is_point1_outer = false;
};

// Values at one instant.
struct NodeDummyMotion {
  NodeDummyMotion(std::size_t inner_modes, std::size_t outer_modes)
      : y(inner_modes), g(inner_modes), r(outer_modes), X(outer_modes), pull(outer_modes) {}
  math::Vec3 arm;             // P_A - p_F [m]
  math::Vec3 h;               // N
  math::Mat3 p_ang, p_lin;    // first about C's origin, then about F's
  math::Mat3 R, DR;           // R, D^-1 R: rows by coordinate of the joint
  std::vector<math::Vec3> y;  // columns of (2)
  std::vector<math::Vec3> g;  // columns of (6)
  std::vector<math::Vec3> r, X;
  std::vector<double> pull;  // of (7), by mode of C
};

// Fills Model::node_dummies and the ranges of links from the coupled masses from `first` on, which the recursion does
// not take as those of a joint. Allocates.
void add_node_dummies(Model& model, std::size_t first);

// Call before factorize(): (1), and (6) of dummies on one body.
void begin_node_dummies(const Model& model, Workspace& ws) noexcept;

// Call after the elimination of the modes and the joint of a link: (3) to (6).
void couple_node_dummies(const Model& model, std::size_t link, Workspace& ws) noexcept;

// solve_forward(): (7) for the joint, once its rates are known without z, and then for the modes.
void pull_joint(const Model& model, std::size_t link, std::span<double> udot, Workspace& ws) noexcept;
void pull_modes(const Model& model, std::size_t link, std::span<double> udot, Workspace& ws) noexcept;

// solve_backward(): adds the load on A by the residuals of a link's modes and the rates of its joint to the wrenches n,
// f on all links and the residuals of the modes.
void back_substitute(const Model& model, std::size_t link, const Workspace& ws, std::span<double> residual,
                     std::span<const double> rate, std::span<math::Vec3> n, std::span<math::Vec3> f) noexcept;

}  // namespace slew::multibody
