// SPDX-License-Identifier: Apache-2.0
// The passes of the body-coordinate formulation. Internal to the library.
#pragma once

#include <span>

#include "multibody/formulations/body_coordinates.h"

namespace slew::multibody {

inline constexpr int kBody = 6;  // speeds of a link

// Poses and velocities of all links; accelerations with u' = 0, as in LinkMotion.
void update_body_motion(const Model& model, const BodyState& state, Workspace& ws) noexcept;

// The same, and the loads (apply_all()); joints: as in find_joint_coordinates().
void apply_all(const Model& model, const BodyState& state, State& joints, Workspace& ws) noexcept;

// Rows of all joints and gears, from the motion. near: joint coordinates whose whole turns the gears' angles continue.
void evaluate_joints(const Model& model, const BodyModel& body, const State& near, Workspace& ws,
                     BodyWorkspace& bws) noexcept;

// Writes minus the violation of the joints' rows into the right-hand side bws.solution.
template <typename Value>
void put_rows(const BodyModel& body, BodyWorkspace& bws, Value value) noexcept {
  for (std::size_t i = 1; i < body.joints.size(); ++i) {
    double* x = bws.solution.data() + bws.ldl.first_row(static_cast<int>(i) - 1) + body.row_offset(i);
    const auto first = static_cast<std::size_t>(bws.first_row[i]);
    for (std::size_t k = 0; k < body.joints[i].rows.size(); ++k) x[k] = -value(bws.rows[first + k]);
  }
  const std::size_t first_gear = bws.rows.size() - bws.gears.size();
  for (std::size_t k = 0; k < bws.gears.size(); ++k) {
    const int row = bws.ldl.first_row(body.first_gear + static_cast<int>(k));
    bws.solution[static_cast<std::size_t>(row)] = -value(bws.rows[first_gear + k]);
  }
}

// Motion, elements and the factors of the matrix; the right-hand side without row forces in bws.solution. False when
// the matrix is singular to working precision.
[[nodiscard]] bool prepare(const Model& model, const BodyModel& body, const BodyState& state, State& joints,
                           Workspace& ws, BodyWorkspace& bws) noexcept;

// project() with the factors of an implicit stage first, [M + tau D + tau sigma K  G^T; G  0]: a correction in the
// metric of M alone strains stiff elements, which then swing.
[[nodiscard]] bool project_softly(const Model& model, const BodyModel& body, BodyState& state, State& joints,
                                  Workspace& ws, BodyWorkspace& bws) noexcept;

// Writes into the right-hand side: minus the wrenches that the links and the dummies between them need, at the
// accelerations that the motion holds, and minus b of the joints' rows.
void put_bias(const Model& model, const BodyModel& body, const Workspace& ws, BodyWorkspace& bws) noexcept;

// The matrix of equation (1) into bws.ldl, from inertias, joints and coupled masses.
void fill_matrix(const Model& model, const BodyModel& body, const Workspace& ws, BodyWorkspace& bws) noexcept;

// A row in body coordinates: the action of its unit force on two links, and x'' with u' = 0.
struct BodyRow {
  int link1 = 0, link2 = 0;
  RowGradient J;
  double x = 0, v = 0, bias = 0;
};
[[nodiscard]] BodyRow body_row(const Model& model, const BodyModel& body, const State& joints, const Row& row,
                               const Workspace& ws) noexcept;

// x, v, a_free and W of all rows in ws, by the factors of the matrix and the accelerations without row forces in
// bws.free.
void find_rows(const Model& model, const BodyModel& body, const State& joints, Workspace& ws,
               BodyWorkspace& bws) noexcept;

// Adds the row's force to a right-hand side; the row's acceleration in a solution, without its bias.
void add_row(const BodyRow& row, double force, const math::BlockLdl& ldl, std::span<double> x) noexcept;
[[nodiscard]] double along(const BodyRow& row, const math::BlockLdl& ldl, std::span<const double> x) noexcept;

// (2) of row_hold.h at a stage of rk4: adds the answers of the rows' laws to the accelerations of its motion.
// responses: by row, of the start; both by first_row().
void answer_rows(const Model& model, const BodyModel& body, const State& joints, const math::BlockLdl& ldl,
                 std::span<const double> responses, Workspace& ws, std::span<double> accelerations) noexcept;

// Velocities or accelerations of links and modes in a solution, laid out as BodyState::u.
void read_bodies(const BodyModel& body, const math::BlockLdl& ldl, std::span<const double> solution,
                 std::span<double> u) noexcept;

}  // namespace slew::multibody
