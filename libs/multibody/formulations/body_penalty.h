// SPDX-License-Identifier: Apache-2.0
// The mechanism in body coordinates with joints that are held by penalties (formulations `penalty` and `augmented`):
// six speeds a link as in body_coordinates.h, and one matrix that is positive definite for any rows,
//
//   A = M + G^T alpha G,    alpha = f m_0 for rows in m, f m_0 l^2 for rows in 1                        (1)
//                           (of a gear over the square of its ratio where that exceeds 1, lengths in l)
//
// M, Q, G, g, b: body_coordinates.h and constraint.h; f the scene's penalty_factor, m_0 the mechanism's mass, l its
// length (penalty_length()). Rows may repeat each other and may become dependent in a singular position: they only add
// existing stiffness.
//
// penalty: a constraint is a mass alpha with a spring and a damper of its own,
//   A u' = Q - G^T alpha (b + 2 xi omega g' + omega^2 g)                                               (2)
// integrated by the fourth-order Runge-Kutta method, without projection onto the joints. Under a force F along a row
// its g goes to F / (alpha omega^2), and u' is wrong by a share of the order 1/f. At a distance phi from a position in
// which rows become dependent, a direction is held by alpha phi^2 alone, less than its own mass m within sqrt(m/alpha).
// So a step is divided into parts p that are halved until every stage has the matrix of the first one but for a share
// c, and violations close faster than the position is approached:
//   |ln(d_stage/d_first)| <= c,   omega_p = max(omega, C/p) where p is a small share of h                (9)
// d: root of the determinant of each node's block in the factors. A step that violates (9), or leaves joints open by
// more than kHeldByPenalty, is reported.
//
// augmented: the same matrix solves for exact multipliers, since the residual of the penalty is added to them and
// solved for again. Accelerations:
//   M u' + G^T lambda = Q,   G u' + b = 0                                                              (3)
//   u' += A^-1 (Q - M u' - G^T (lambda + alpha (G u' + b))),   lambda += alpha (G u' + b)              (4)
// each round gains a factor of about f. A step of h takes the trapezoidal rule with the positions as unknowns and the
// joints closed at its end ("index 3"),
//   u_1 = u_0 + h/2 (u_0' + u_1'),  d = h/2 (u_0 + u_1),  p_1 = p_0 + d_p,  R_1 = exp(d_R~) R_0        (5)
//   M u_1' + G^T lambda = Q(q_1, u_1),   g(q_1) = 0                                                    (6)
// by Newton's method on d, lambda carried along (an external spring of 4 alpha / h^2 on every row),
//   A_h delta = h^2/4 (Q - M u_1' - G^T lambda) - G^T alpha g,   lambda += 4/h^2 alpha (g + G delta)   (7)
//   A_h = A + h/2 C + h^2/4 K
// C, K: slopes of all force elements and contacts (link_stiffness.h), and in K the pulls on a link at s from its origin
// with T . s > 0, across s: multipliers, and its own weight and inertia. Light links between heavy ones are strings,
// which no step resolves.
// (5) takes the mean of a row's force alone. What a change within the step moves the mechanism beside it is part of the
// positions, and not of d:
//   A_h d_r = -h^3/12 J^T slope,   p_1 = p_0 + d_p + d_r,p,   R_1 = exp((d_R + d_r,R)~) R_0             (10)
// By the mean of both ends, (5) makes energy of a one-sided force that begins or ends within the step (stops.h). Such a
// step is divided until the part p in which that happens is short; p takes the implicit Euler rule,
//   u_1 = u_0 + p u_1',  d = p u_1,   (7) with p^2 for h^2/4 and p for h/2                            (11)
// (11) is of first order: it moves all links, touched or not, by p^2 u'/2 too far. p is divided until that is small.
// The remainder of (5) in G u is removed in the metric of A_h, and u_1' of the next step comes from (3):
//   u := u - A_h^-1 G^T alpha G u   until G u = 0                                                      (8)
// (8) is the velocity projection, (3) the acceleration projection of the sources; both need no matrix of their own.
//
// Sources: (2) flexible-body tutorial thesis (2017), equation 7 as corrected in the errata; (4) Bayo and Ledesma 1996;
// (5) to (8) Cuadrado et al. 2000 and 2004, Dopico et al. 2014. Deviations: alpha is scaled by the mechanism; rotations
// in (5) by the exponential, as u is no derivative of coordinates; (3) in the metric of M, and from the state alone, so
// that only q and u are carried from step to step: row forces jump between steps. C and K neglect the turning of
// gradients; the right sides are exact.
//
// One node of math::BlockLdl holds a link: the cost is linear in the number of links. Only the builders allocate.
#pragma once

#include <span>
#include <vector>

#include "math/block_ldl.h"
#include "multibody/formulations/body_coordinates.h"

namespace slew::multibody {

struct PenaltyModel {
  Formulation formulation = Formulation::augmented;  // or penalty
  BodyModel bodies;                                  // joints of the tree, for the coordinates of rows
  std::vector<Constraint> constraints;
  std::vector<int> first_row;  // by constraint, and the number of their rows at the end
  std::vector<double> alpha;   // by row [kg or kg m2]; those of gears come last
  double length = 1;           // m, l of (1)
  math::BlockPattern pattern;  // node i - 1: link i; then modes
  std::vector<ModalBlock> modal;
  // by constraint: for a node's joint, start of m_k of its rows, and of the modes among the speeds
  struct ModalRows {
    std::size_t first = 0, place = 0, modes = 0;
  };
  std::vector<ModalRows> modal_rows;
};

struct PenaltyWorkspace {
  PenaltyWorkspace(const Model& model, const PenaltyModel& body);

  math::BlockLdl ldl;
  std::vector<RowValue> rows;                              // rows of all constraints, by first_row; then of gears
  std::vector<GearRow> gears, factored_gears;              // gears with their gradients, and those in the factors
  std::vector<RowGradient> factored;                       // G in the factors
  std::vector<double> modal, factored_modal;               // the same of m_k
  std::vector<double> target;                              // by row: G u' required by (2) or (3), with the sign of b
  std::vector<double> force, correction;                   // by u
  std::vector<double> free, free_multipliers;              // without row forces
  std::vector<double> responses, response_multipliers;     // by row of the model: responses to its unit force alone
  std::vector<double> multipliers;                         // lambda, by row
  std::vector<double> no_target;                           // zeros
  std::vector<double> rates;                               // G u less the prescribed speeds, by row
  std::vector<double> qdot, udot, end_udot, displacement;  // values of a step
  std::vector<double> row_displacement;                    // d_r of (10)
  std::vector<double> trapezoid_displacement;              // d + d_r of a part that (11) takes
  std::vector<double> last_correction;                     // by u
  std::vector<StopMotion> stops, stops_0;                  // one-sided forces at the end and the start of a part
  BodyState stage, sum;
  State stage_joints;
  std::vector<double> row_force;
  int iterations = 0;             // iterations of Newton's method in the last part
  int parts = 1;                  // parts of the last step, of `augmented`
  std::vector<double> part_mean;  // mean of the rows' forces over a part

  // penalty
  std::vector<double> determinants;  // d_first of (9), by node
  double change = 0;                 // left side of (9), the largest of the last part
  double frequency = 0;              // rad/s, omega_p
};

// m: the largest distance of a joint's point from the origin of a moving link that it is fixed to, or radius of
// gyration about such an origin.
[[nodiscard]] double penalty_length(const Model& model, std::span<const Constraint> constraints) noexcept;
// kg: links, the dummies between them, and flexible bodies whose frames are at Ground.
[[nodiscard]] double moving_mass(const Model& model) noexcept;

// Constraints: joints of the tree and all other connections of links. Allocates.
[[nodiscard]] PenaltyModel build_penalty_model(const Model& model, Formulation formulation,
                                               std::span<const Constraint> more = {});

// As evaluate() of body_coordinates.h: rows with a_free and W of (2) or (3). False when the matrix is singular to
// working precision or (4) did not settle.
[[nodiscard]] bool evaluate(const Model& model, const PenaltyModel& body, const BodyState& state, State& joints,
                            Workspace& ws, PenaltyWorkspace& pws) noexcept;

// After evaluate(): accelerations of all links for the given row forces; their multipliers in pws.multipliers.
void accelerations(const Model& model, PenaltyWorkspace& pws, std::span<const double> row_forces,
                   std::span<double> udot) noexcept;

// One step of h [s] after evaluate(), with the rows' forces as advance() of dynamics.h takes them. The motion in ws is
// then that of the new state. False when a matrix was singular, Newton's method did not converge, (9) was violated, or
// the joints did not reach kHeld (`penalty`: kHeldByPenalty).
[[nodiscard]] bool advance(const Model& model, const PenaltyModel& body, BodyState& state, State& joints, Workspace& ws,
                           PenaltyWorkspace& pws, double h, std::span<const double> mean,
                           std::span<const double> slope) noexcept;

inline constexpr double kHeld = 1e-8;  // m, 1; per second; of the mechanism's size and speed where these exceed 1
inline constexpr double kHeldByPenalty = 1e-5;  // m, 1; of the mechanism's size where it exceeds 1

// After evaluate() or advance(): the largest g and g' of all rows.
[[nodiscard]] Drift drift(const PenaltyWorkspace& pws) noexcept;

// Longest step [s] for which the Runge-Kutta method damps a row of (2), by its amplification at the roots of
// s^2 + 2 xi omega s + omega^2.
[[nodiscard]] double longest_penalty_step(double damping_ratio, double frequency) noexcept;

}  // namespace slew::multibody
