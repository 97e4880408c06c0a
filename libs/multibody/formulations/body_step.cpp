// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "multibody/constraints/loops.h"
#include "multibody/formulations/body_passes.h"
#include "multibody/formulations/body_runge_kutta.h"

namespace slew::multibody {

namespace {

constexpr int kMostBodyCorrections = 20;  // Newton with one matrix: an error of 1e-2 is gone after five

// accelerations of a stage
bool find_accelerations(const Model& model, const BodyModel& body, const BodyState& state,
                        std::span<const double> forces, Workspace& ws, BodyWorkspace& bws) noexcept {
  const bool is_regular = prepare(model, body, state, bws.stage_joints, ws, bws);
  for (std::size_t k = 0; k < model.rows.size(); ++k) {
    if (ws.row_is_active[k] == 0) continue;
    add_row(body_row(model, body, bws.stage_joints, model.rows[k], ws), forces[k], bws.ldl, bws.solution);
  }
  bws.ldl.solve(bws.solution);
  if (ws.hold != nullptr) answer_rows(model, body, bws.stage_joints, bws.ldl, bws.responses, ws, bws.solution);
  read_bodies(body, bws.ldl, bws.solution, bws.udot);
  return is_regular;
}

// moves every link and mode by the small displacement in bws.solution
void displace(const BodyModel& body, BodyState& state, const BodyWorkspace& bws) noexcept {
  const std::size_t links = state.links();
  for (const ModalBlock& block : body.modal) {
    const double* delta = bws.solution.data() + bws.ldl.first_row(block.node);
    for (std::size_t k = 0; k < block.count; ++k) state.q[7 * links + block.place + k] += delta[k];
  }
  for (std::size_t link = 1; link <= links; ++link) {
    const double* delta = bws.solution.data() + bws.ldl.first_row(static_cast<int>(link) - 1);
    for (std::size_t k = 0; k < 3; ++k) state.q[7 * (link - 1) + k] += delta[k];
    const math::Quaternion half{1, 0.5 * delta[3], 0.5 * delta[4], 0.5 * delta[5]};
    put_attitude(math::normalized(half * attitude_at(state.q, link)), state.q, link);
  }
}

// adds a share of a solution's link and mode entries to speeds
void add_bodies(const BodyModel& body, const math::BlockLdl& ldl, std::span<const double> solution, double share,
                std::span<double> u) noexcept {
  const std::size_t links = static_cast<std::size_t>(body.links) - 1;
  const auto add = [&](int node, std::size_t count, std::size_t place) {
    const double* delta = solution.data() + ldl.first_row(node);
    for (std::size_t k = 0; k < count; ++k) u[place + k] += share * delta[k];
  };
  for (std::size_t link = 0; link < links; ++link) add(static_cast<int>(link), 6, 6 * link);
  for (const ModalBlock& block : body.modal) add(block.node, block.count, 6 * links + block.place);
}

// the displacement or change of speed that removes the violation of the joints' rows
template <typename Value>
void solve_violation(const BodyModel& body, BodyWorkspace& bws, Value value) noexcept {
  std::fill(bws.solution.begin(), bws.solution.end(), 0.0);
  put_rows(body, bws, value);
  bws.ldl.solve(bws.solution);
}

// (3), both with the present factors; needs the motion and the joints' rows. False: the joints were not closed.
bool remove_violation(const Model& model, const BodyModel& body, BodyState& state, const State& joints, Workspace& ws,
                      BodyWorkspace& bws) noexcept {
  const Extent extent = extent_of(ws);
  const double closed = kClosed * extent.length, steady = kClosed * extent.speed;
  Drift left = drift(bws);
  for (int i = 0; i < kMostBodyCorrections && left.position > closed; ++i) {
    solve_violation(body, bws, [](const RowValue& row) { return row.g; });
    displace(body, state, bws);
    update_body_motion(model, state, ws);
    evaluate_joints(model, body, joints, ws, bws);
    left = drift(bws);
  }
  for (int i = 0; i < kMostBodyCorrections && left.rate > steady; ++i) {
    solve_violation(body, bws, [](const RowValue& row) { return row.rate; });
    add_bodies(body, bws.ldl, bws.solution, 1, state.u);
    update_body_motion(model, state, ws);
    evaluate_joints(model, body, joints, ws, bws);
    left = drift(bws);
  }
  return left.position <= closed && left.rate <= steady;
}

}  // namespace

bool project(const Model& model, const BodyModel& body, BodyState& state, State& joints, Workspace& ws,
             BodyWorkspace& bws) noexcept {
  const bool is_regular = prepare(model, body, state, joints, ws, bws);
  const bool is_closed = remove_violation(model, body, state, joints, ws, bws);
  find_joint_coordinates(model, ws, joints);
  return is_regular && is_closed;
}

bool project_softly(const Model& model, const BodyModel& body, BodyState& state, State& joints, Workspace& ws,
                    BodyWorkspace& bws) noexcept {
  if (bws.ldl.smallest_pivot() >= kNearSingular) {
    update_body_motion(model, state, ws);
    evaluate_joints(model, body, joints, ws, bws);
    static_cast<void>(remove_violation(model, body, state, joints, ws, bws));
  }
  return project(model, body, state, joints, ws, bws);
}

bool project_step(const Model& model, const BodyModel& body, double h, BodyState& state, State& joints, Workspace& ws,
                  BodyWorkspace& bws) noexcept {
  update_body_motion(model, state, ws);
  const double closed = kClosed * extent_of(ws).length;
  for (int i = 0; i < kMostBodyCorrections && bws.ldl.smallest_pivot() >= kNearSingular; ++i) {
    evaluate_joints(model, body, joints, ws, bws);
    if (!(drift(bws).position > closed)) break;
    solve_violation(body, bws, [](const RowValue& row) { return row.g; });
    displace(body, state, bws);
    add_bodies(body, bws.ldl, bws.solution, 1 / h, state.u);
    update_body_motion(model, state, ws);
  }
  return project(model, body, state, joints, ws, bws);
}

bool advance(const Model& model, const BodyModel& body, BodyState& state, State& joints, Workspace& ws,
             BodyWorkspace& bws, double h, std::span<const double> mean, std::span<const double> slope) noexcept {
  for (std::size_t k = 0; k < mean.size(); ++k) bws.row_force[k] = mean[k] - 0.5 * h * slope[k];
  accelerations(model, body, bws, bws.row_force, bws.udot);
  if (ws.hold != nullptr) {
    answer_rows(model, body, joints, bws.ldl, bws.responses, ws, bws.solution);
    read_bodies(body, bws.ldl, bws.solution, bws.udot);
  }
  const bool is_regular = step_by_runge_kutta(model, state, joints, ws, bws, h, mean, slope, [&](BodyState& stage) {
    const bool is_near_singular = bws.ldl.smallest_pivot() < kNearSingular;
    const bool is_closed = !is_near_singular || project(model, body, stage, bws.stage_joints, ws, bws);
    return find_accelerations(model, body, stage, bws.row_force, ws, bws) && is_closed;
  });
  const bool is_closed = project(model, body, state, joints, ws, bws);
  accept_contacts(model, h, joints, ws);
  return is_closed && is_regular;
}

}  // namespace slew::multibody
