// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "core/index.h"
#include "multibody/constraints/loops.h"
#include "multibody/contacts/contact_passes.h"
#include "multibody/forces/coupled_mass.h"
#include "multibody/formulations/body_passes.h"
#include "multibody/formulations/passes.h"
#include "multibody/joints/joint_directions.h"

namespace slew::multibody {

using math::Vec3;

namespace {

double* body_at(const math::BlockLdl& ldl, std::vector<double>& x, int link) noexcept {
  return x.data() + ldl.first_row(link - 1);
}

}  // namespace

void put_bias(const Model& model, const BodyModel& body, const Workspace& ws, BodyWorkspace& bws) noexcept {
  for (std::size_t i = 1; i < model.links.size(); ++i) {
    double* x = body_at(bws.ldl, bws.solution, static_cast<int>(i));
    put(-ws.inertia[i].f, x);
    put(-ws.inertia[i].n, x + 3);
  }
  for (const ModalBlock& block : body.modal) {
    double* x = bws.solution.data() + bws.ldl.first_row(block.node);
    for (std::size_t k = 0; k < block.count; ++k) x[k] = -ws.parts[block.part].bias[block.first + k];
  }
  put_rows(body, bws, [](const RowValue& row) { return row.bias; });
  for (std::size_t i = 0; i < model.coupled.size(); ++i) {
    const LineElement& line = model.lines[at(model.coupled[i].line)];
    const LineMotion& motion = ws.lines[at(model.coupled[i].line)];
    const auto need = [&](int link, Vec3 point, Vec3 force) {
      if (link == 0) return;
      double* x = body_at(bws.ldl, bws.solution, link);
      subtract(force, x);
      subtract(cross(point - ws.motion[at(link)].p, force), x + 3);
    };
    need(line.link1, motion.P1, ws.coupled[i].F1);
    need(line.link2, motion.P2, ws.coupled[i].F2);
  }
}

void evaluate_joints(const Model& model, const BodyModel& body, const State& near, Workspace& ws,
                     BodyWorkspace& bws) noexcept {
  for (std::size_t i = 1; i < body.joints.size(); ++i) {
    const Constraint& joint = body.joints[i];
    const std::span<RowValue> rows(bws.rows.data() + bws.first_row[i], joint.rows.size());
    if (joint.node >= 0) {
      evaluate_node(model, joint, ws, rows, std::span(bws.modal).subspan(at(bws.first_modal[i])));
      continue;
    }
    evaluate(joint, ws.motion[at(joint.link1)], ws.motion[at(joint.link2)], ws.drives, rows);
  }
  const std::size_t first_gear = bws.rows.size() - bws.gears.size();
  for (std::size_t k = 0; k < bws.gears.size(); ++k) {
    const GearRow row = gear_row(model, body, near, model.gears[k], ws);
    bws.gears[k] = row;
    bws.rows[first_gear + k] = {.g = row.g, .rate = row.rate, .bias = row.bias, .G = {}};
  }
}

void apply_all(const Model& model, const BodyState& state, State& joints, Workspace& ws) noexcept {
  update_body_motion(model, state, ws);
  find_joint_coordinates(model, ws, joints);
  apply_all(model, joints.q, ws);
}

bool prepare(const Model& model, const BodyModel& body, const BodyState& state, State& joints, Workspace& ws,
             BodyWorkspace& bws) noexcept {
  apply_all(model, state, joints, ws);
  evaluate_joints(model, body, joints, ws, bws);
  fill_matrix(model, body, ws, bws);
  const bool is_regular = bws.ldl.factorize(kDependent);
  put_bias(model, body, ws, bws);
  return is_regular;
}

void find_rows(const Model& model, const BodyModel& body, const State& joints, Workspace& ws,
               BodyWorkspace& bws) noexcept {
  const std::size_t rows = model.rows.size(), size = bws.solution.size();
  for (std::size_t k = 0; k < rows; ++k) {
    const BodyRow row = body_row(model, body, joints, model.rows[k], ws);
    ws.row_x[k] = row.x;
    ws.row_v[k] = row.v;
    const bool is_active = ws.row_is_active[k] != 0;
    ws.row_a_free[k] = is_active ? row.bias + along(row, bws.ldl, bws.free) : 0.0;
    const std::span<double> response(bws.responses.data() + k * size, size);
    std::fill(response.begin(), response.end(), 0.0);
    if (!is_active) continue;
    add_row(row, 1, bws.ldl, response);
    bws.ldl.solve(response);
  }
  for (std::size_t k = 0; k < rows; ++k) {
    const BodyRow row = body_row(model, body, joints, model.rows[k], ws);
    for (std::size_t l = 0; l <= k; ++l) {
      const bool is_active = ws.row_is_active[k] != 0 && ws.row_is_active[l] != 0;
      const double w = is_active ? along(row, bws.ldl, {bws.responses.data() + l * size, size}) : 0.0;
      ws.row_W[k * rows + l] = ws.row_W[l * rows + k] = w;
    }
  }
}

bool evaluate(const Model& model, const BodyModel& body, const BodyState& state, State& joints, Workspace& ws,
              BodyWorkspace& bws) noexcept {
  begin_contacts(model, joints, ws);
  set_time(model, joints.time, ws);
  const bool is_regular = prepare(model, body, state, joints, ws, bws);
  bws.ldl.solve(bws.solution);
  bws.free = bws.solution;
  find_rows(model, body, joints, ws, bws);
  return is_regular;
}

void read_bodies(const BodyModel& body, const math::BlockLdl& ldl, std::span<const double> solution,
                 std::span<double> u) noexcept {
  const std::size_t links = at(body.links) - 1;
  for (std::size_t i = 0; i < links; ++i) {
    std::copy_n(solution.data() + ldl.first_row(static_cast<int>(i)), 6, u.data() + 6 * i);
  }
  for (const ModalBlock& block : body.modal) {
    std::copy_n(solution.data() + ldl.first_row(block.node), block.count, u.data() + 6 * links + block.place);
  }
}

void accelerations(const Model& model, const BodyModel& body, BodyWorkspace& bws, std::span<const double> row_forces,
                   std::span<double> udot) noexcept {
  bws.solution = bws.free;
  const std::size_t size = bws.solution.size();
  for (std::size_t k = 0; k < model.rows.size(); ++k) {
    const double* response = bws.responses.data() + k * size;
    for (std::size_t i = 0; i < size; ++i) bws.solution[i] += response[i] * row_forces[k];
  }
  read_bodies(body, bws.ldl, bws.solution, udot);
}

}  // namespace slew::multibody
