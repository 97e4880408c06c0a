// SPDX-License-Identifier: Apache-2.0
// Flexible bodies in the mechanism: modes that ride on a link, and the links of their nodes.
//
// The link of a flexible body is its frame; the modes are coordinates q, u = q' of their own, after those of the joints
// (State). A node at which something is attached is a link without mass or coordinates, LinkJoint::node, whose motion
// is that of the frame and of the modes, with theta = sum_k psi_k q_k and T the left Jacobian of the rotation vector:
//   p = p_F + R_F (x + phi q + 1/2 g q q),  R = R_F exp(theta~) R_N                                     (1)
//   v = v_F + w_F x r + sum_k Phi_k u_k,    w = w_F + sum_k Psi_k u_k,   Phi_k = R_F (phi_k + g_kl q_l),
//   Psi_k = R_F T psi_k                                                                                 (2)
// With b = C + G q and c_k = ax(Z_k + (Y_lk + H_lk) q_l), ax(int a b^T) = int a x b, in the frame of the link,
//   s(q) = s_0 + C q + 1/2 G q q,   W(q) = W_0 + (Z + Z^T) q + (Y + 1/2 (H + H^T)) q q,   J = tr W - W   (3)
// Lagrange's equations of T(v, w, u, q) in quasi-velocities (Boltzmann and Hamel) are, with A the time derivative in
// the frame and a, alpha, w its motion,
//   f   = m a + alpha x s + b u' + w x (w x s) + 2 w x (b u) + (G u) u                                  (4)
//   n   = s x a + J alpha + c u' + w x (J w) + (dJ/dt) w + w x (c u) + ax(H u u)                         (5)
//   0   = b . a + c . alpha + M u' + 2 w . ax(Y_lk) u_l - 1/2 w . (dJ/dq_k) w + K q + D u - Q_0          (6)
// so that energy and momentum of (3) are kept at any truncation of (3). Equations 34 to 36 of the flexible-body
// tutorial thesis (2017), -A u~ G as in the errata; quadratic terms as Shabana, chapter 5.
//
// The recursion takes the modes as coordinates outside of the frame's joint:
//   B = (c, b) + sum over nodes X^T I_A (Psi, Phi),  E = M + sum (Psi, Phi)^T I_A (Psi, Phi)             (7)
//   I_A of the frame loses B E^-1 B^T before its own joint is eliminated (articulated.cpp)
// With E = C C^T all passes take the modes as C^T q, whose mass is 1: X = C^-1 B^T, residuals and rates of modes are
// C^-1 times those of (6), and their accelerations C^-T times the result,
//   I_A -= X^T X,   u' = C^-T (C^-1 r - X (alpha, a))                                                    (8)
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "math/rotation.h"
#include "multibody/flexible/modal_body.h"

namespace slew::multibody {

// int a x b of int a b^T
[[nodiscard]] inline math::Vec3 axial(const math::Mat3& W) noexcept {
  return {W(1, 2) - W(2, 1), W(2, 0) - W(0, 2), W(0, 1) - W(1, 0)};
}

// Pairs k, l at k * modes + l; vectors and matrices in the axes of the link, moments about its origin.
struct FlexiblePart {
  std::string name{};  // name of the body
  int body = 0;        // Model::bodies
  int link = 0;        // its frame
  int q = 0, u = 0;    // first modal coordinate in State::q and State::u
  std::size_t modes = 0;
  bool is_start_given = false;
  std::shared_ptr<const ModalBody> source{};  // the body before it was turned into the link's axes
  std::vector<std::size_t> watched{};         // its nodes that move most in one of the modes, and the last one
  double length = 0;                          // m, length_of() it
  std::vector<math::Vec3> C, G;
  std::vector<math::Mat3> Z, Y, H;
  std::vector<math::Vec3> Y_cross, H_cross;  // ax(Y), ax(H) by pair
  std::vector<double> mass_matrix, stiffness, damping;
  std::vector<double> preload;  // elastic force at q = 0, u = 0, by mode; 0 unless a partner publishes it
  bool is_diagonal = false;     // stiffness and damping are diagonal, as for modes of the whole body
  [[nodiscard]] bool is_shortening() const noexcept { return !G.empty(); }
};

// Node of a link with LinkJoint::node.
struct FlexibleNode {
  int part = 0;                         // Model::parts
  math::Vec3 x;                         // m, undeformed, in the frame's link
  math::Mat3 R;                         // R_N, of the node's link at rest in the frame's link
  std::vector<math::Vec3> shift, turn;  // phi, psi by mode
  std::vector<math::Vec3> shortening;   // g by pair; empty: none
};

// A part at one instant. In the axes of the frame's link: s and J less their values at q = 0; the others in Ground axes
// about its origin.
struct PartMotion {
  explicit PartMotion(std::size_t modes);
  std::vector<double> q, u;
  math::Vec3 s_L;  // kg m
  math::Mat3 J_L;  // kg m2
  math::Vec3 s;    // the same in Ground axes
  math::Mat3 J;
  math::Vec3 f, n;                       // terms of (4), (5) by speeds alone [N, N m]
  std::vector<math::Vec3> b, c;          // coefficients of (4), (5)
  std::vector<math::Mat3> W_q;           // dW/dq_k, in the axes of the frame's link
  std::vector<double> bias;              // right side of (6) with u' = 0
  std::vector<math::Vec3> B_lin, B_ang;  // columns of (7)
  std::vector<double> E;                 // then its Cholesky factor (small_cholesky.h)
  std::vector<math::Vec3> X_lin, X_ang;  // C^-1 B^T, by mode
};

struct NodeMotion {
  explicit NodeMotion(std::size_t modes) : Phi(modes), Psi(modes) {}
  std::vector<math::Vec3> Phi, Psi;  // columns of (2)
};

// What an interval adds to the masses and elastic forces of all modes: position K + rate D to M, strain K u to the
// force.
struct ModalShares {
  double position = 0;  // s2
  double rate = 0;      // s
  double strain = 0;    // s
  [[nodiscard]] bool any() const noexcept { return position != 0 || rate != 0 || strain != 0; }
};

struct Model;
struct Workspace;
struct LinkMotion;
struct ArticulatedInertia;

// Shape and inertia of the part at modal coordinates and speeds, for the motion of its frame. Part of update_motion().
void see_part(const FlexiblePart& part, std::span<const double> q, std::span<const double> u, const LinkMotion& frame,
              PartMotion& motion) noexcept;

// (1), (2): motion of a node's link; accelerations with u' = 0.
void move_node(const FlexibleNode& node, const LinkMotion& frame, const PartMotion& part, NodeMotion& motion,
               LinkMotion& m) noexcept;

// Inertia and bias wrench of (4), (5) beyond those of the undeformed body; starts (7) and the bias of (6).
void add_part(const FlexiblePart& part, const LinkMotion& frame, PartMotion& motion,
              ArticulatedInertia& inertia) noexcept;
// After add_part().
void add_shares(const FlexiblePart& part, const ModalShares& shares, PartMotion& motion) noexcept;

// The recursion: a node's articulated inertia into the modes, after it went into the frame's; then the modes out of the
// frame's inertia, with their residuals. Where E is singular the accelerations are not finite.
void add_node(const Model& model, std::size_t link, Workspace& ws) noexcept;
void eliminate_modes(const Model& model, std::size_t part, Workspace& ws) noexcept;

// solve_forward(): accelerations of the modes after those of the frame, and their part in those of a node's link.
void solve_modes(const Model& model, std::size_t part, const Workspace& ws, std::span<const double> residual,
                 std::span<double> udot) noexcept;
void follow_node(const Model& model, std::size_t link, std::span<const double> udot, Workspace& ws) noexcept;

// C^-1 x in place, and for three right sides X = C^-1 B; C^-T x in place.
void pass_modes(const PartMotion& motion, std::span<double> x) noexcept;
void pass_modes(const PartMotion& motion, const std::vector<math::Vec3>& B, std::vector<math::Vec3>& X) noexcept;
void return_modes(const PartMotion& motion, std::span<double> x) noexcept;

struct PartEnergy {
  double kinetic = 0, potential = 0;  // J, beyond those of the undeformed body
};
// (4), (5) beyond those of the undeformed body, for accelerations of modes (empty: zero) and frame, after add_part().
struct PartWrench {
  math::Vec3 f, n;  // N; N m about the frame's origin
};
[[nodiscard]] PartWrench wrench_of(const PartMotion& motion, std::span<const double> udot, math::Vec3 alpha,
                                   math::Vec3 a) noexcept;

struct PartMomentum {
  math::Vec3 linear, angular;  // kg m/s; kg m2/s about the frame's origin; the same
};
[[nodiscard]] PartMomentum momentum_of(const PartMotion& motion, const LinkMotion& frame) noexcept;
[[nodiscard]] PartEnergy energy_of(const FlexiblePart& part, const PartMotion& motion, const LinkMotion& frame,
                                   math::Vec3 gravity) noexcept;

}  // namespace slew::multibody
