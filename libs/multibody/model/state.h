// SPDX-License-Identifier: Apache-2.0
// Mutable data of a mechanism: the state itself, and the workspace of a step.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "core/state_bytes.h"
#include "core/state_hash.h"
#include "math/semidefinite.h"
#include "multibody/constraints/closing_pattern.h"
#include "multibody/contacts/contact_workspace.h"
#include "multibody/flexible/flexible_part.h"
#include "multibody/model/link_motion.h"
#include "multibody/model/model.h"

namespace slew::multibody {

// Coordinates and speeds in the layout of model.h, and the memory of contacts; this is the whole integrated state. The
// steps add their length to the time, which an owner with its own clock may set between them.
struct State {
  std::vector<double> q;              // rad, m, quaternions
  std::vector<double> u;              // rad/s, m/s
  double time = 0;                    // s, for loads that follow a table
  std::vector<double> bristles{};     // rad or m, bending of joint friction by row; empty: no joint has bristles
  contact::ContactMemory contacts{};  // impact speeds and bristles at the end of the last sub-step
};

// Articulated inertia about the link's origin, Ground axes, and the bias wrench:
//   n = J alpha + K^T a + n0 (moment),  f = K alpha + M a + f0 (force)
// J and M are symmetric: 21 different numbers, kept as nine columns.
struct ArticulatedInertia {
  math::Mat3 J, K, M;
  math::Vec3 n, f;
};

// Results of the backward pass for the solutions with this inertia. With S the joint's free directions,
// U = (IA + coupled masses) S, D = S^T U: one coordinate uses U_ang.c[0], U_lin.c[0], d_inv; spherical all; floating
// holds the inverse blocks (see articulated.cpp).
struct JointFactor {
  math::Mat3 U_ang, U_lin, D_inv;
  double d_inv = 0;
};

// Geometry of a line element at one instant.
struct LineMotion {
  math::Vec3 P1, P2;  // m
  math::Vec3 e;       // unit(P1 - P2)
  math::Vec3 w;       // m/s, velocity of P1 relative to P2
  double length = 0;  // m
  double rate = 0;    // m/s
};

struct AngleMotion {
  math::Vec3 n;  // gradient: d(angle)/dt = w_rel . n
  double angle = 0, rate = 0;
};

// A CoupledMass at one instant; s1, s2 from the child link's origin.
struct CoupledMotion {
  math::Vec3 s1, s2, e;
  math::Vec3 F1, F2;                 // N, forces that the points need with u' = 0
  double a11 = 0, a12 = 0, a22 = 0;  // kg, across the line
};

// Gradient of a row with respect to the velocities of both links' origins and their angular velocities.
struct RowGradient {
  math::Vec3 v1, w1, v2, w2;
};

// A row between two links at one instant: a constraint value, or a coordinate.
struct RowValue {
  double g = 0;     // m or 1
  double rate = 0;  // g' [m/s or 1/s]
  double bias = 0;  // b [m/s2 or 1/s2]: g'' = G a + b
  RowGradient G;
};

// Reaction of a joint on its body 1: force and moment about the joint's point of body 2, Ground axes [N, N m].
// It includes the forces of the joint's own row. Fixed joints are included.
struct JointReaction {
  Triple force{}, moment{};
};

// Rows of all cut joints, then of gears, filled by close_loops().
struct LoopWorkspace {
  [[nodiscard]] double mobility(std::size_t row) const noexcept {
    return W[static_cast<std::size_t>(factor.entry(static_cast<int>(row), static_cast<int>(row)))];
  }

  ClosingPattern pattern;
  std::vector<RowValue> rows;
  std::vector<double> residual, rate;  // rows x speeds, of solve_backward(); zero except on the speeds of the row's
                                       // group
  std::vector<double> W;               // by factor.entry()
  std::vector<double> multipliers;     // by row: the force that closes it, -lambda [N or N m]
  std::vector<double> step;            // by u
  std::vector<double> gear_tau;        // by u, zero except while a gear's row is passed back
  math::Semidefinite factor;
  std::vector<double> shown_q, shown_u;  // coordinates of the present motion and rows' values,
  bool is_shown = false;                 // true if they are valid: see are_shown() of loops.h
};

class RowHold;
class TreeMatrix;

struct Workspace {
  explicit Workspace(const Model& model);
  // compiled once, in the source file
  ~Workspace();
  Workspace(Workspace&&) noexcept;
  Workspace& operator=(Workspace&&) noexcept;

  double time = 0;                  // s, time of the motion
  std::vector<MotionValue> drives;  // by Model::drives, at that time: set_time()
  double until = kNever;            // s, end of the present piece: set_time() leaves jumps of p'' there to the next one
  double mean_over = 0;             // s; not 0: set_time() takes mean accelerations over so long from then on
  std::vector<LinkMotion> motion;
  std::vector<ArticulatedInertia> inertia;
  std::vector<JointFactor> factor;
  std::vector<PartMotion> parts;
  ModalShares shares;  // of the owner: all zero at an instant
  std::vector<NodeMotion> nodes;
  std::vector<NodeDummyMotion> node_dummies;
  std::vector<CoupledMotion> coupled;
  std::vector<LineMotion> lines;
  std::vector<AngleMotion> angles;
  std::vector<math::Vec3> delta_alpha, delta_a;  // accelerations caused by u'
  std::vector<math::Vec3> pass_n, pass_f;        // wrenches passed towards Ground in a back-solve, by row and link

  std::vector<double> tau;       // generalised forces of joint rows, by u
  std::vector<double> residual;  // residual of the backward pass, by u
  std::vector<double> udot;      // by u, of the last forward dynamics

  // rows: filled by evaluate_rows()
  std::vector<double> row_x, row_v, row_a_free;
  std::vector<double> row_J;                 // rows x dof
  std::vector<double> row_residual;          // rows x dof, r of solve_backward()
  std::vector<double> row_rate;              // rows x dof, D^-1 r
  std::vector<double> row_W;                 // rows x rows
  std::vector<double> row_force;             // row forces of the current stage
  std::vector<double> row_part;              // mean over a part of a sub-step
  const TreeMatrix* across = nullptr;        // of the owner: elements across joints, for factorize()
  RowHold* hold = nullptr;                   // of the owner, corrects row forces in the stages of rk4: row_hold.h
  std::vector<unsigned char> row_is_active;  // 0 or 1

  // smallest reactions: reactions to a unit force in each redundant row, by row and joint of the scene; scratch for
  // them
  std::vector<math::Vec3> unit_force, unit_moment;
  std::vector<double> unit_residual, unit_rate, unit_products, unit_shares;
  math::Semidefinite unit_factor;
  std::vector<JointReaction> found_reactions;

  std::vector<double> gear_force;  // by gear, of the last joint_reactions() [N or N m]

  // by body of the scene: sums of joint_reactions(), about the origin of the body's link
  std::vector<math::Vec3> body_n, body_f;

  LoopWorkspace loops;
  std::unique_ptr<ContactWorkspace> contact;  // none: no pairs

  // Runge-Kutta
  std::vector<double> q_stage, u_stage, qdot, q_sum, u_sum, udot_free, residual_free;
};

// Start of the scene.
[[nodiscard]] State start_state(const Model& model);

// Takes over another state of the same mechanism. Does not allocate.
void copy_state(const State& from, State& to) noexcept;

// Raw bits of coordinates, speeds, contacts and live parameters in id order.
void add_to_hash(const Model& model, const State& state, StateHash& hash) noexcept;

// The same as bytes, with time and the elastic laws of flexible parts. load() recomputes values that depend on the
// parameters; after invalid bytes, model and state must not be used.
void save(const Model& model, const State& state, StateWriter& bytes);
void load(Model& model, State& state, StateReader& bytes);

}  // namespace slew::multibody
