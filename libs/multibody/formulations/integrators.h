// SPDX-License-Identifier: Apache-2.0
// The integrators of a sub-step beside Runge-Kutta, for both formulations: `recursive` in joint coordinates, `lagrange`
// in body coordinates.
//
// semi_implicit_euler (order 1, symplectic):  u_1 = u_0 + h f(q_0, u_0),  q_1 = q_0 (+) h u_1                  (1)
// The implicit ones solve for the speeds u of a stage with coordinates and acceleration linear in them,
//   q = q_0 (+) (d + sigma u),   a = (u - u*) / tau,   a = f(q, u)                                           (2)
//   trapezoidal        tau = sigma = h/2, u* = u_0 + h/2 f_0, d = h/2 u_0;  order 2, keeps what oscillates
//   sdirk2             two stages with tau = sigma = gamma h, gamma = 1 - 1/sqrt 2; u* and d are u_0 and 0, then with
//                      (1 - gamma) h times a and u of the first;  order 2, L-stable
//   generalised_alpha  order 2; an algorithmic acceleration A is carried from sub-step to sub-step,
//     (1 - alpha_m) A_1 + alpha_m A_0 = (1 - alpha_f) f_1 + alpha_f f_0,   u_1 = u_0 + h ((1 - gamma) A_0 + gamma A_1),
//     q_1 = q_0 (+) (h u_0 + h^2 ((1/2 - beta) A_0 + beta A_1)),   alpha_m = (2 rho - 1)/(rho + 1),
//     alpha_f = rho/(rho + 1), gamma = 1/2 - alpha_m + alpha_f, beta = (1/2 + gamma)^2/4                     (3)
//     carried is A - f, so that a jump of f between two sub-steps is one of A as well.
//     The mean rows' forces give an acceleration r at the start, which is not part of f and A: they add h r and h^2/2
//     r, so that an impact, or friction that varies by sub-step, has no effect on later sub-steps.
// (+) adds plain coordinates and turns quaternions by the exponential in Ground axes; (1) turns a link on a ball with
// the angular velocity that the new speeds give it about the axes of q_0. f: accelerations of the mechanism, of the
// form (1) of body_coordinates.h for any integrated coordinates, so that stiff elements, joints and loops are solved
// together. Newton's method in body coordinates:
//   [ M + tau D + tau sigma K  G^T ] [ delta ]         [ Q - M a - G^T lambda ]
//   [ G                        0   ] [ mu    ]  =  tau [ -b - G a             ],   lambda += mu/tau          (4)
// lambda stands on the right, since a matrix with the G of an earlier correction would leave a force across the joints.
// In joint coordinates the recursion solves (4) where K and D follow the tree (tree_matrix.h), with a new matrix at
// every correction; elsewhere, near a singular position, and where it is slow, the matrix is that of body coordinates.
// M a - Q by Newton and Euler with all forces at the stage, so that the result does not depend on the left side; K and
// D: those of all force elements and contacts (link_stiffness.h) and, once the iteration proves slow, the pull of a
// joint's force F at s from a link's origin, (F . s) across s where it is positive. It omits gyroscopic and centrifugal
// terms, row forces, pushing joints. In joint coordinates delta is read off as relative speeds. A force that jumps at
// the edge of a stop takes a value between its two there: (4) is relaxed if it alternates. A sub-step in which a stop
// is touched or left, or changes in iterations that do not settle, uses tau = sigma = h, u* = u_0, d = 0 instead of the
// rule: of order 1, but without energy gain from a spring that only pushes, unlike the other rules for contacts shorter
// than h. The same holds in the middle of an impact with a frequency or damping rate above kUnresolved/h. After the
// step the state is projected onto the joints (project()).
//
// The trapezoid has an error of h^2/12 (a_1 - a_0) in a turn, the others nearly as much. A sub-step in which it exceeds
// both kLargestTurnError and the turn itself has not resolved a whip; small ringing of stiff laws passes. For any
// angular coordinate:  min(h^2/12 |a_1 - a_0|, h/2 |u_0 + u_1|) <= kLargestTurnError                (5)
//
// A force of a row moves a mass m under it by h^2/2 mean - h^3/12 slope over m. The rules take the mean alone (sdirk2 a
// part of the slope), so that a blow at the start of the sub-step would move it by half of its effect. After the last
// stage the coordinates take what is left out, by the stage's matrix of (4), so that stiff elements share it:
//   q (+) [M + tau D + tau sigma K  G^T; G  0]^-1 J^T (share h^3 slope),   share = -1/12, sdirk2 -0.0404 (6)
//
// Row forces are the owner's, linear in time over the sub-step (dynamics.h). The number of corrections is bounded, an
// iteration without convergence is reported. Only the builders allocate.
// Sources: trapezoidal rule, sdirk2: Alexander 1977; (3) Chung and Hulbert 1993, with rotations as Brüls, Cardona and
// Arnold 2012. Deviation: positions are not part of the iteration's unknowns, and joints are held by accelerations
// inside it, by projection after it.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "multibody/formulations/body_coordinates.h"
#include "multibody/formulations/tree_matrix.h"
#include "multibody/model/state.h"

namespace slew::multibody {

// The default rule of a formulation, and all its rules, the default first.
[[nodiscard]] Integrator own_integrator(Formulation formulation) noexcept;
[[nodiscard]] std::span<const Integrator> integrators_of(Formulation formulation) noexcept;

struct StepRule {
  Integrator integrator = Integrator::rk4;
  double spectral_radius = 0.8;       // rho of (3)
  double iteration_tolerance = 1e-9;  // relative to the mechanism's largest speed, at least 1 m/s, 1 rad/s
};
[[nodiscard]] StepRule step_rule(const MechanicsDef& mechanics) noexcept;  // its integrator is never `own`
// Largest error of a turn in an implicit sub-step, by (5).
inline constexpr double kLargestTurnError = 3e-3;  // rad
[[nodiscard]] constexpr bool is_implicit(Integrator integrator) noexcept {
  return integrator >= Integrator::trapezoidal && integrator <= Integrator::sdirk2;
}

// Integrated state: in joint coordinates, or in body coordinates with joint coordinates beside them.
struct Moving {
  State& joints;
  BodyState* bodies = nullptr;  // null: joint coordinates
};

struct StageWorkspace {
  enum class Coordinates { joint, body };  // integrated coordinates
  StageWorkspace(const Model& model, const BodyModel& body, Coordinates coordinates);

  std::vector<double> q_0, u_0;                 // at the start of the sub-step
  std::vector<double> rate_0, rate;             // u' at its start and in the stage, by u
  std::vector<double> fixed, base;              // u* and d of (2), by u
  std::vector<double> algorithmic;              // A - f of (3) at the end of the last sub-step, by u
  std::vector<double> step, last_step;          // by u
  std::vector<std::size_t> turning;             // entries of u that are free angular velocities
  std::vector<math::Vec3> turn;                 // d for the quaternions of joint coordinates, by link
  std::vector<math::Vec3> turn_0, turn_rate_0;  // angular velocity and acceleration at the start, by link
  std::vector<math::Vec3> algorithmic_turn;     // A of the same
  std::vector<double> row_rate;                 // r of (3)
  std::vector<math::Vec3> row_turn_rate;        // r of the same, by link
  std::vector<signed char> stops, stops_0;      // one-sided forces, as see_stops(): now, at the start
  std::vector<double> row_force;
  std::optional<TreeMatrix> tree;   // of joint coordinates without gears
  bool is_in_tree = false;          // the last stage's factors are those of the recursion
  std::vector<double> multipliers;  // lambda of the stage, by BlockLdl::first_row(); entries of speeds are not used
  bool has_pulls = false;           // the matrix has the pull of the joints
  bool has_stops = false;
  bool takes_touch = false;       // set by the owner: take the sub-step as one in which a stop is touched
  bool has_alternated = false;    // a stop changed in an iteration of the sub-step
  bool is_near_singular = false;  // near a singular position in the sub-step, as in loops.h
  int iterations = 0;             // iterations of the last sub-step
};

// The body model with a coupling for every force element, whose stiffness becomes part of (4). Allocates.
[[nodiscard]] BodyModel build_stiff_body_model(const Model& model);

// (1) in joint coordinates, after evaluate(); row_forces: their mean over h, one per row.
// False: the loops could not be closed.
[[nodiscard]] bool advance_by_euler(const Model& model, State& state, Workspace& ws, double h,
                                    std::span<const double> row_forces) noexcept;

// One sub-step of h [s] with a rule other than rk4 and than (1) in joint coordinates, after evaluate() of the
// formulation. bws: of the stiff body model. False: a matrix was singular, the iteration did not settle, the joints
// were not closed, or a turn is wrong by more than kLargestTurnError.
[[nodiscard]] bool advance(const Model& model, const BodyModel& body, const StepRule& rule, Moving moving,
                           Workspace& ws, BodyWorkspace& bws, StageWorkspace& stages, double h,
                           std::span<const double> mean, std::span<const double> slope) noexcept;

}  // namespace slew::multibody
