// SPDX-License-Identifier: Apache-2.0
// The mechanism in body coordinates (formulation `lagrange`): every link has six speeds of its own, and the joints are
// constraints whose multipliers are found with the accelerations.
//
//   [ M  G^T ] [ u'     ]   [ Q  ]      M masses of the links and of the dummies between them, G and b of constraint.h,
//   [ G   0  ] [ lambda ] = [ -b ]      Q gravity, elements, rows and the velocity terms of M                    (1)
//   g(q) = 0,  g' = G u = 0                                                                                      (2)
// A joint exerts -G^T lambda on its links. (1) keeps g'' at zero only, so the coordinates are projected onto (2) after
// every step: the nearest ones in the metric of M, by Newton's method for g and one solution for g',
//   [ M  G^T ] [ delta ]   [ 0      ]
//   [ G   0  ] [ mu    ] = [ -g(q)  ]   and the same with -G u                                                   (3)
// Equations 4 to 6 of the flexible-body tutorial thesis (2017), Q_c with the sign and the velocity terms of the errata;
// (3) is the mass-orthogonal projection of Bayo and Ledesma 1996 with exact multipliers.
//
// Layout of the state: link i has q at 7 (i - 1): position and quaternion w x y z of the link in Ground; u at 6 (i -
// 1): velocity of the link's origin, angular velocity, both in Ground axes. The modes of flexible parts come after all
// links (flexible/body_modes.h), with nodes of their own in the matrix. One node of math::BlockLdl holds a link and
// its joint towards Ground, a closing node the rows of a joint that is cut, or that of a gear: the cost is linear in
// the number of links, but for the fill along loops. Only the builders allocate.
#pragma once

#include <cmath>
#include <span>
#include <vector>

#include "math/block_ldl.h"
#include "multibody/constraints/constraint.h"
#include "multibody/flexible/body_modes.h"
#include "multibody/model/state.h"

namespace slew::multibody {

struct BodyModel {
  int links = 0;                   // Ground included
  std::vector<Constraint> joints;  // by link, [0] is empty and link1 the parent; then the cut joints
  math::BlockPattern pattern;      // node i - 1: of joints[i]; of the tree: link i and the rows of its joint; modes
  std::vector<ModalBlock> modal;   // nodes of the modes
  int first_gear = 0;              // node of the first gear's row; the others follow

  // First row of a joint among those of its node.
  [[nodiscard]] int row_offset(std::size_t joint) const noexcept { return static_cast<int>(joint) < links ? 6 : 0; }
};

struct BodyState {
  std::vector<double> q, u;
  // 7 n + m and 6 n + m of them
  [[nodiscard]] std::size_t links() const noexcept { return q.size() - u.size(); }
};

struct BodyWorkspace {
  BodyWorkspace(const Model& model, const BodyModel& body);

  math::BlockLdl ldl;
  std::vector<RowValue> rows;     // rows of all joints, by first_row; then of gears, without gradients
  std::vector<int> first_row;     // by joint
  std::vector<GearRow> gears;     // rows of gears, the last ones in `rows`
  std::vector<double> modal;      // m_k of body_modes.h for the rows of nodes' joints
  std::vector<int> first_modal;   // by joint
  std::vector<double> solution;   // u' and the multipliers, by ldl.first_row()
  std::vector<double> free;       // the same without row forces
  std::vector<double> responses;  // by row of the model: the response to its unit force alone
  // Runge-Kutta
  BodyState stage, sum;
  State stage_joints;
  std::vector<double> qdot, udot, row_force;
};

// Allocate. The state is that of joint coordinates and speeds.
[[nodiscard]] BodyModel build_body_model(const Model& model);
[[nodiscard]] BodyState body_state(const Model& model, const State& state);

// Joint coordinates and speeds of the motion in ws. Angles continue those of the state, over any number of turns.
void find_joint_coordinates(const Model& model, const Workspace& ws, State& joints) noexcept;

// As evaluate() of dynamics.h: motion, elements and rows (x, v, a_free, W) in ws. joints: joint coordinates of the
// previous state, then of this one. False when the matrix is singular to working precision.
[[nodiscard]] bool evaluate(const Model& model, const BodyModel& body, const BodyState& state, State& joints,
                            Workspace& ws, BodyWorkspace& bws) noexcept;

// After evaluate(): accelerations of all links for the given row forces, laid out as BodyState::u; the multipliers stay
// in bws.solution.
void accelerations(const Model& model, const BodyModel& body, BodyWorkspace& bws, std::span<const double> row_forces,
                   std::span<double> udot) noexcept;

// One step of h [s] with the fourth-order Runge-Kutta method and (3), after evaluate() and with the rows' forces as
// advance() of dynamics.h takes them. The motion in ws is then that of the new state. False if a matrix was singular or
// the projection did not reach kClosed.
[[nodiscard]] bool advance(const Model& model, const BodyModel& body, BodyState& state, State& joints, Workspace& ws,
                           BodyWorkspace& bws, double h, std::span<const double> mean,
                           std::span<const double> slope) noexcept;

// (3) alone: projects a state onto the joints. Needs no evaluation.
[[nodiscard]] bool project(const Model& model, const BodyModel& body, BodyState& state, State& joints, Workspace& ws,
                           BodyWorkspace& bws) noexcept;

// The same for an impulse step of h [s] after evaluate() at its start: the positions are corrected with the matrix of
// the start, and the speeds get the correction over h (project_step() of loops.h).
[[nodiscard]] bool project_step(const Model& model, const BodyModel& body, double h, BodyState& state, State& joints,
                                Workspace& ws, BodyWorkspace& bws) noexcept;

// After evaluate(): the largest violation of (2), positions [m or 1] and rates [m/s or 1/s].
struct Drift {
  double position = 0, rate = 0;

  // A NaN stays.
  void add(const RowValue& row) noexcept {
    const auto raise = [](double& largest, double value) {
      if (value > largest || std::isnan(value)) largest = value;
    };
    raise(position, std::fabs(row.g));
    raise(rate, std::fabs(row.rate));
  }
};
[[nodiscard]] Drift drift(const BodyWorkspace& bws) noexcept;

}  // namespace slew::multibody
