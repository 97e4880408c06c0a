// SPDX-License-Identifier: Apache-2.0
// Right-hand sides of the penalty formulations, and solutions with the factors of their matrix.
#include <algorithm>
#include <cmath>

#include "core/index.h"
#include "core/reductions.h"
#include "multibody/contacts/contact_passes.h"
#include "multibody/formulations/passes.h"
#include "multibody/formulations/penalty_passes.h"
#include "multibody/formulations/spatial_block.h"
#include "multibody/joints/joint_directions.h"

namespace slew::multibody {

using math::Vec3;

namespace {

// rounds of (4), each with a gain of f; a well-conditioned mechanism needs three
constexpr int kMostRounds = 10;
// corrections below this share of the solution are rounding, and so are small ones that stop shrinking
constexpr double kRounding = 1e-14;
constexpr double kSmall = 1e-9;
constexpr double kStalled = 0.5;
// Nearly dependent rows would need more rounds than the limit in the direction that they are about to release: the
// residual is a share of its acceleration. A larger residual means a wrong matrix.
constexpr double kSettled = 1e-3;
// m/s2, rad/s2: a mechanism at rest has only rounding, which is no scale for itself
constexpr double kAtRest = 1e-14;

Vec3 vector_at(const double* x) noexcept {
  return {x[0], x[1], x[2]};
}

double* link_at(std::span<double> x, int link) noexcept {
  return x.data() + kLinkSpeeds * (at(link) - 1);
}

const double* link_at(std::span<const double> x, int link) noexcept {
  return x.data() + kLinkSpeeds * (at(link) - 1);
}

// inertia of a part's modes, with each other and with their frame
void subtract_modal_mass(const Model& model, const Workspace& ws, std::size_t index, std::span<const double> x,
                         std::span<double> y) noexcept {
  const FlexiblePart& part = model.parts[index];
  const PartMotion& motion = ws.parts[index];
  const std::size_t place = kLinkSpeeds * (model.links.size() - 1) + modal_place(model, index);
  const bool is_moving = part.link > 0;
  const Vec3 a = is_moving ? vector_at(link_at(x, part.link)) : Vec3();
  const Vec3 alpha = is_moving ? vector_at(link_at(x, part.link) + 3) : Vec3();
  for (std::size_t k = 0; k < part.modes; ++k) {
    double force = dot(motion.b[k], a) + dot(motion.c[k], alpha);
    for (std::size_t l = 0; l < part.modes; ++l) force += part.mass_matrix[k * part.modes + l] * x[place + l];
    y[place + k] -= force;
    if (!is_moving) continue;
    subtract(motion.b[k] * x[place + k], link_at(y, part.link));
    subtract(motion.c[k] * x[place + k], link_at(y, part.link) + 3);
  }
}

// a force on a point of a link
void subtract_force(int link, Vec3 s, Vec3 force, std::span<double> y) noexcept {
  if (link == 0) return;
  subtract(force, link_at(y, link));
  subtract(cross(s, force), link_at(y, link) + 3);
}

}  // namespace

void see(const Model& model, const PenaltyModel& body, const BodyState& state, State& joints, Workspace& ws,
         PenaltyWorkspace& pws) noexcept {
  apply_all(model, state, joints, ws);
  for (std::size_t i = 0; i < body.constraints.size(); ++i) {
    const Constraint& constraint = body.constraints[i];
    const std::span<RowValue> rows(pws.rows.data() + body.first_row[i], constraint.rows.size());
    if (constraint.node >= 0) {
      evaluate_node(model, constraint, ws, rows, std::span(pws.modal).subspan(body.modal_rows[i].first));
      continue;
    }
    evaluate(constraint, ws.motion[at(constraint.link1)], ws.motion[at(constraint.link2)], ws.drives, rows);
  }
  const std::size_t first_gear = pws.rows.size() - pws.gears.size();
  for (std::size_t k = 0; k < pws.gears.size(); ++k) {
    const GearRow row = gear_row(model, body.bodies, joints, model.gears[k], ws);
    pws.gears[k] = row;
    pws.rows[first_gear + k] = {.g = row.g, .rate = row.rate, .bias = row.bias, .G = {}};
  }
}

void put_free_forces(const Model& model, const Workspace& ws, std::span<double> y) noexcept {
  std::fill(y.begin(), y.end(), 0.0);
  for (std::size_t i = 1; i < model.links.size(); ++i) {
    double* at_link = link_at(y, static_cast<int>(i));
    subtract(ws.inertia[i].f, at_link);
    subtract(ws.inertia[i].n, at_link + 3);
  }
  for (std::size_t index = 0; index < model.parts.size(); ++index) {
    double* x = y.data() + kLinkSpeeds * (model.links.size() - 1) + modal_place(model, index);
    for (std::size_t k = 0; k < model.parts[index].modes; ++k) x[k] = -ws.parts[index].bias[k];
  }
  for (std::size_t i = 0; i < model.coupled.size(); ++i) {
    const LineElement& line = model.lines[at(model.coupled[i].line)];
    const LineMotion& m = ws.lines[at(model.coupled[i].line)];
    subtract_force(line.link1, m.P1 - ws.motion[at(line.link1)].p, ws.coupled[i].F1, y);
    subtract_force(line.link2, m.P2 - ws.motion[at(line.link2)].p, ws.coupled[i].F2, y);
  }
}

void subtract_mass(const Model& model, const Workspace& ws, std::span<const double> x, std::span<double> y) noexcept {
  for (std::size_t i = 1; i < model.links.size(); ++i) {
    const ArticulatedInertia& I = ws.inertia[i];
    const Vec3 a = vector_at(link_at(x, static_cast<int>(i))), alpha = vector_at(link_at(x, static_cast<int>(i)) + 3);
    double* at_link = link_at(y, static_cast<int>(i));
    subtract(I.K * alpha + I.M * a, at_link);
    subtract(I.J * alpha + transpose_multiply(I.K, a), at_link + 3);
  }
  for (std::size_t index = 0; index < model.parts.size(); ++index) subtract_modal_mass(model, ws, index, x, y);
  for (std::size_t i = 0; i < model.coupled.size(); ++i) {
    const LineElement& line = model.lines[at(model.coupled[i].line)];
    const LineMotion& m = ws.lines[at(model.coupled[i].line)];
    const Vec3 s1 = m.P1 - ws.motion[at(line.link1)].p, s2 = m.P2 - ws.motion[at(line.link2)].p;
    const auto point = [&](int link, Vec3 s) {
      if (link == 0) return Vec3();
      return vector_at(link_at(x, link)) + cross(vector_at(link_at(x, link) + 3), s);
    };
    const Vec3 a1 = point(line.link1, s1), a2 = point(line.link2, s2);
    const PointMasses A = point_masses(model.coupled[i], ws.coupled[i]);
    subtract_force(line.link1, s1, A.A11 * a1 + A.A12 * a2, y);
    subtract_force(line.link2, s2, A.A12 * a1 + A.A22 * a2, y);
  }
}

namespace {

HeldRow row_of(const PenaltyModel& body, std::size_t constraint, std::size_t row, const RowGradient& G,
               std::span<const double> modal) noexcept {
  const Constraint& joint = body.constraints[constraint];
  const PenaltyModel::ModalRows& modes = body.modal_rows[constraint];
  const std::size_t first = modes.first + (row - at(body.first_row[constraint])) * modes.modes;
  return {joint.link1, joint.link2, G, modal.subspan(first, modes.modes), modes.place};
}

}  // namespace

HeldRow present_row(const PenaltyModel& body, const PenaltyWorkspace& pws, std::size_t constraint,
                    std::size_t row) noexcept {
  return row_of(body, constraint, row, pws.rows[row].G, pws.modal);
}

HeldRow factored_row(const PenaltyModel& body, const PenaltyWorkspace& pws, std::size_t constraint,
                     std::size_t row) noexcept {
  return row_of(body, constraint, row, pws.factored[row], pws.factored_modal);
}

void subtract_row(const HeldRow& row, double mu, std::span<double> y) noexcept {
  if (row.gear != nullptr) {
    for_each_end(*row.gear, [&](int link, Vec3 v, Vec3 w) {
      subtract(v * mu, link_at(y, link));
      subtract(w * mu, link_at(y, link) + 3);
    });
    return;
  }
  if (row.link1 > 0) {
    subtract(row.G.v1 * mu, link_at(y, row.link1));
    subtract(row.G.w1 * mu, link_at(y, row.link1) + 3);
  }
  if (row.link2 > 0) {
    subtract(row.G.v2 * mu, link_at(y, row.link2));
    subtract(row.G.w2 * mu, link_at(y, row.link2) + 3);
  }
  for (std::size_t k = 0; k < row.modal.size(); ++k) y[row.place + k] -= row.modal[k] * mu;
}

double along(const HeldRow& row, std::span<const double> x) noexcept {
  double sum = 0;
  if (row.gear != nullptr) {
    for_each_end(*row.gear, [&](int link, Vec3 v, Vec3 w) {
      sum += dot(v, vector_at(link_at(x, link))) + dot(w, vector_at(link_at(x, link) + 3));
    });
    return sum;
  }
  if (row.link1 > 0) {
    const double* one = link_at(x, row.link1);
    sum += dot(row.G.v1, vector_at(one)) + dot(row.G.w1, vector_at(one + 3));
  }
  if (row.link2 > 0) {
    const double* two = link_at(x, row.link2);
    sum += dot(row.G.v2, vector_at(two)) + dot(row.G.w2, vector_at(two + 3));
  }
  for (std::size_t k = 0; k < row.modal.size(); ++k) sum += row.modal[k] * x[row.place + k];
  return sum;
}

bool solve(const Model& model, const PenaltyModel& body, const Workspace& ws, PenaltyWorkspace& pws,
           std::span<const double> force, std::span<const double> target, std::span<double> x,
           std::span<double> multipliers) noexcept {
  const bool is_exact = body.formulation == Formulation::augmented;
  std::fill(x.begin(), x.end(), 0.0);
  std::fill(multipliers.begin(), multipliers.end(), 0.0);
  double before = 0, whole = kAtRest, share = 0;
  for (int round = 0; round < kMostRounds; ++round) {
    // residual of the equation of motion; in a plain penalty the multipliers are those of x alone
    std::copy(force.begin(), force.end(), pws.correction.begin());
    if (round > 0) subtract_mass(model, ws, x, pws.correction);
    for_each_factored(body, pws, [&](std::size_t row, const HeldRow& held) {
      const double missed = body.alpha[row] * (along(held, x) + target[row]);
      if (is_exact && round > 0) multipliers[row] += missed;
      subtract_row(held, multipliers[row] + missed, pws.correction);
    });
    pws.ldl.solve(pws.correction);
    for (std::size_t k = 0; k < x.size(); ++k) x[k] += pws.correction[k];
    // nearly balanced forces have a sum below their rounding
    const double size = fixed_max_abs(pws.correction);
    whole = std::max(whole, fixed_max_abs(x));
    share = size / whole;
    if (share <= kRounding || (share <= kSmall && size > kStalled * before)) break;
    before = size;
  }
  for_each_factored(body, pws, [&](std::size_t row, const HeldRow& held) {
    multipliers[row] += body.alpha[row] * (along(held, x) + target[row]);
  });
  return share <= kSettled;
}

}  // namespace slew::multibody
