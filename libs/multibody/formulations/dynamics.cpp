// SPDX-License-Identifier: Apache-2.0
#include "multibody/formulations/dynamics.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/check.h"
#include "core/reductions.h"
#include "multibody/constraints/loops.h"
#include "multibody/constraints/rows.h"
#include "multibody/contacts/contact_passes.h"
#include "multibody/formulations/passes.h"
#include "multibody/formulations/row_hold.h"

namespace slew::multibody {
void find_loads(const Model& model, std::span<const double> q, std::span<const double> u, Workspace& ws) noexcept {
  if (!ws.loops.is_shown || !are_shown(model, q, u, ws)) {
    update_motion(model, q, u, ws);
    evaluate_cuts(model, q, u, ws);
  }
  std::fill(ws.tau.begin(), ws.tau.end(), 0.0);
  apply_all(model, q, ws);
}

void solve_accelerations(const Model& model, Workspace& ws) noexcept {
  factorize(model, ws);
  if (model.has_closing_rows()) {
    factorize_cuts(model, ws);
    close_loops(model, ws);
  }
  solve_forward(model, ws, ws.residual, ws.udot);
}

void forward_dynamics(const Model& model, std::span<const double> q, std::span<const double> u,
                      std::span<const double> row_forces, Workspace& ws) noexcept {
  find_loads(model, q, u, ws);
  if (!row_forces.empty()) {
    std::copy(row_forces.begin(), row_forces.end(), ws.row_force.begin());
    apply_row_forces(model, ws);
  }
  solve_accelerations(model, ws);
}

void evaluate(const Model& model, const State& state, Workspace& ws) noexcept {
  begin_contacts(model, state, ws);
  set_time(model, state.time, ws);
  forward_dynamics(model, state.q, state.u, {}, ws);
  ws.udot_free = ws.udot;
  ws.residual_free = ws.residual;
  evaluate_rows(model, state, ws);
}

void accelerations(const Model& model, Workspace& ws, std::span<const double> row_forces,
                   std::span<double> udot) noexcept {
  const std::size_t dof = ws.udot.size();
  std::copy(ws.residual_free.begin(), ws.residual_free.end(), ws.residual.begin());
  for (std::size_t k = 0; k < row_forces.size(); ++k) {
    if (ws.row_is_active[k] == 0) continue;
    const double* residual = ws.row_residual.data() + k * dof;
    for (std::size_t j = 0; j < dof; ++j) ws.residual[j] += residual[j] * row_forces[k];
  }
  solve_forward(model, ws, ws.residual, udot);
  impose_accelerations(model, ws, udot);
}

void response_column(const Model& model, Workspace& ws, int row, std::span<double> column) noexcept {
  const std::size_t dof = ws.udot.size();
  const std::span<const double> residual(ws.row_residual.data() + static_cast<std::size_t>(row) * dof, dof);
  solve_forward(model, ws, residual, column);
}

void normalize_quaternions(const Model& model, std::span<double> q) noexcept {
  for (std::size_t i = 1; i < model.links.size(); ++i) {
    const Link& link = model.links[i];
    if (link.joint != LinkJoint::spherical && link.joint != LinkJoint::floating) continue;
    const std::size_t k = static_cast<std::size_t>(link.q) + (link.joint == LinkJoint::floating ? 3 : 0);
    const math::Quaternion unit = math::normalized({q[k], q[k + 1], q[k + 2], q[k + 3]});
    q[k] = unit.w;
    q[k + 1] = unit.x;
    q[k + 2] = unit.y;
    q[k + 3] = unit.z;
  }
}

namespace {

// y = x + scale * rate
void combine(std::span<const double> x, double scale, std::span<const double> rate, std::span<double> y) noexcept {
  for (std::size_t i = 0; i < x.size(); ++i) y[i] = x[i] + scale * rate[i];
}

void row_forces_at(double t, double h, std::span<const double> mean, std::span<const double> slope,
                   std::span<double> forces) noexcept {
  for (std::size_t k = 0; k < mean.size(); ++k) forces[k] = mean[k] + (t - 0.5 * h) * slope[k];
}

// u' of a stage with the answer of the rows' laws, (2) of row_hold.h
void answer_excess(Workspace& ws) noexcept {
  const std::span<const double> forces = ws.hold->answer();
  for (std::size_t k = 0; k < forces.size(); ++k) {
    if (ws.row_is_active[k] == 0 || forces[k] == 0) continue;
    const std::span<const double> column = ws.hold->column(k);
    for (std::size_t j = 0; j < column.size(); ++j) ws.udot[j] += column[j] * forces[k];
  }
}

// the first stage, after accelerations() of the rows' forces; also takes the columns
void hold_at_start(const Model& model, double time, Workspace& ws) noexcept {
  const std::size_t rows = model.rows.size();
  for (std::size_t k = 0; k < rows; ++k) {
    double excess = 0;
    if (ws.row_is_active[k] != 0) {
      response_column(model, ws, static_cast<int>(k), ws.hold->column(k));
      excess = ws.row_a_free[k] - ws.hold->expected(k, time);
      for (std::size_t l = 0; l < rows; ++l) excess += ws.row_W[k * rows + l] * ws.row_force[l];
    }
    ws.hold->set_excess(k, excess);
  }
  answer_excess(ws);
}

void hold_at_stage(const Model& model, double time, Workspace& ws) noexcept {
  for (std::size_t k = 0; k < model.rows.size(); ++k) {
    const bool is_active = ws.row_is_active[k] != 0;
    const double a = is_active ? row_acceleration(model, ws, k, ws.udot, ws.hold->gradient(k)) : 0.0;
    ws.hold->set_excess(k, is_active ? a - ws.hold->expected(k, time) : 0.0);
  }
  answer_excess(ws);
}

// stages 2 to 4 and the sum; the first stage's u' is in ws.udot and its motion in ws
bool finish_step(const Model& model, State& state, Workspace& ws, double h, std::span<const double> mean,
                 std::span<const double> slope) noexcept {
  constexpr double kStageTime[3] = {0.5, 0.5, 1.0};
  constexpr double kWeight[4] = {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6};
  coordinate_rates(model, ws, state.q, state.u, ws.qdot);
  combine(state.q, h * kWeight[0], ws.qdot, ws.q_sum);
  combine(state.u, h * kWeight[0], ws.udot, ws.u_sum);
  const std::span<double> forces(ws.row_force.data(), mean.size());
  bool is_closed = true;
  for (int stage = 1; stage < 4; ++stage) {
    const double time = kStageTime[stage - 1] * h;
    combine(state.q, time, ws.qdot, ws.q_stage);
    combine(state.u, time, ws.udot, ws.u_stage);
    set_stage_time(model, state, time, ws);
    impose_positions(model, ws, ws.q_stage);
    impose_speeds(model, ws, ws.u_stage);
    if (is_near_singular(ws)) is_closed = project(model, ws.q_stage, ws.u_stage, ws) && is_closed;
    row_forces_at(time, h, mean, slope, forces);
    forward_dynamics(model, ws.q_stage, ws.u_stage, forces, ws);
    if (ws.hold != nullptr) hold_at_stage(model, state.time + time, ws);
    coordinate_rates(model, ws, ws.q_stage, ws.u_stage, ws.qdot);
    combine(ws.q_sum, h * kWeight[stage], ws.qdot, ws.q_sum);
    combine(ws.u_sum, h * kWeight[stage], ws.udot, ws.u_sum);
  }
  state.q.swap(ws.q_sum);
  state.u.swap(ws.u_sum);
  state.time += h;
  impose_positions(model, ws, state.q);
  impose_speeds(model, ws, state.u);
  normalize_quaternions(model, state.q);
  if (model.has_closing_rows()) is_closed = project(model, state.q, state.u, ws) && is_closed;
  if (ws.contact != nullptr) {
    if (!are_shown(model, state.q, state.u, ws)) show(model, state.q, state.u, ws);
    accept_contacts(model, h, state, ws);
  }
  return is_closed;
}

}  // namespace

bool advance(const Model& model, State& state, Workspace& ws, double h, std::span<const double> mean,
             std::span<const double> slope) noexcept {
  SLEW_ASSERT(mean.size() == model.rows.size() && slope.size() == model.rows.size());
  row_forces_at(0, h, mean, slope, ws.row_force);
  accelerations(model, ws, ws.row_force, ws.udot);
  if (ws.hold != nullptr) hold_at_start(model, state.time, ws);
  return finish_step(model, state, ws, h, mean, slope);
}

bool advance_free(const Model& model, State& state, Workspace& ws, double h) noexcept {
  begin_contacts(model, state, ws);
  set_time(model, state.time, ws);
  forward_dynamics(model, state.q, state.u, {}, ws);
  return finish_step(model, state, ws, h, {}, {});
}

int substep_count(const Model& model, double step) noexcept {
  // a multiple of the sub-step to rounding does not get one sub-step more
  constexpr double kRounding = 1e-9;
  return std::max(1, static_cast<int>(std::ceil(step / model.max_substep * (1 - kRounding))));
}

bool is_finite(const State& state) noexcept {
  return all_finite(state.q) && all_finite(state.u);
}

}  // namespace slew::multibody
