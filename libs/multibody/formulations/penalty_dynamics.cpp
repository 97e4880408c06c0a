// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "multibody/contacts/contact_passes.h"
#include "multibody/formulations/penalty_passes.h"

namespace slew::multibody {

namespace {

// G u' required by (2) or (3), with the sign of b
void put_target(const Model& model, const PenaltyModel& body, PenaltyWorkspace& pws) noexcept {
  const double omega = pws.frequency, xi = model.penalty.damping;
  for (std::size_t row = 0; row < pws.rows.size(); ++row) {
    const RowValue& value = pws.rows[row];
    pws.target[row] = value.bias;
    if (body.formulation == Formulation::penalty) {
      pws.target[row] += 2 * xi * omega * value.rate + omega * omega * value.g;
    }
  }
}

}  // namespace

void add_row_forces(const Model& model, const PenaltyModel& body, const State& joints, const Workspace& ws,
                    std::span<const double> forces, const math::BlockLdl& ldl, std::span<double> y) noexcept {
  for (std::size_t k = 0; k < model.rows.size(); ++k) {
    if (ws.row_is_active[k] == 0) continue;
    add_row(body_row(model, body.bodies, joints, model.rows[k], ws), forces[k], ldl, y);
  }
}

bool prepare(const Model& model, const PenaltyModel& body, const BodyState& state, State& joints, Workspace& ws,
             PenaltyWorkspace& pws) noexcept {
  see(model, body, state, joints, ws, pws);
  put_target(model, body, pws);
  put_free_forces(model, ws, pws.force);
  return factorize(model, body, ws, pws, 0);
}

bool evaluate(const Model& model, const PenaltyModel& body, const BodyState& state, State& joints, Workspace& ws,
              PenaltyWorkspace& pws) noexcept {
  begin_contacts(model, joints, ws);
  set_time(model, joints.time, ws);
  bool is_solved = prepare(model, body, state, joints, ws, pws);
  is_solved = solve(model, body, ws, pws, pws.force, pws.target, pws.free, pws.free_multipliers) && is_solved;
  const std::size_t rows = model.rows.size(), size = pws.free.size(), joint_rows = pws.multipliers.size();
  for (std::size_t k = 0; k < rows; ++k) {
    const BodyRow row = body_row(model, body.bodies, joints, model.rows[k], ws);
    ws.row_x[k] = row.x;
    ws.row_v[k] = row.v;
    const bool is_active = ws.row_is_active[k] != 0;
    ws.row_a_free[k] = is_active ? row.bias + along(row, pws.ldl, pws.free) : 0.0;
    const std::span<double> response(pws.responses.data() + k * size, size);
    const std::span<double> multipliers(pws.response_multipliers.data() + k * joint_rows, joint_rows);
    std::fill(response.begin(), response.end(), 0.0);
    std::fill(multipliers.begin(), multipliers.end(), 0.0);
    if (!is_active) continue;
    std::fill(pws.force.begin(), pws.force.end(), 0.0);
    add_row(row, 1, pws.ldl, pws.force);
    is_solved = solve(model, body, ws, pws, pws.force, pws.no_target, response, multipliers) && is_solved;
  }
  for (std::size_t k = 0; k < rows; ++k) {
    const BodyRow row = body_row(model, body.bodies, joints, model.rows[k], ws);
    for (std::size_t l = 0; l <= k; ++l) {
      const bool is_active = ws.row_is_active[k] != 0 && ws.row_is_active[l] != 0;
      const double w = is_active ? along(row, pws.ldl, {pws.responses.data() + l * size, size}) : 0.0;
      ws.row_W[k * rows + l] = ws.row_W[l * rows + k] = w;
    }
  }
  return is_solved;
}

void accelerations(const Model& model, PenaltyWorkspace& pws, std::span<const double> row_forces,
                   std::span<double> udot) noexcept {
  const std::size_t size = udot.size(), joint_rows = pws.multipliers.size();
  std::copy(pws.free.begin(), pws.free.end(), udot.begin());
  pws.multipliers = pws.free_multipliers;
  for (std::size_t k = 0; k < model.rows.size(); ++k) {
    const double* response = pws.responses.data() + k * size;
    const double* multipliers = pws.response_multipliers.data() + k * joint_rows;
    for (std::size_t i = 0; i < size; ++i) udot[i] += response[i] * row_forces[k];
    for (std::size_t i = 0; i < joint_rows; ++i) pws.multipliers[i] += multipliers[i] * row_forces[k];
  }
}

}  // namespace slew::multibody
