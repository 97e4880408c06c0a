// SPDX-License-Identifier: Apache-2.0
#include "multibody/formulations/body_penalty.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <set>
#include <utility>

#include "core/check.h"
#include "multibody/formulations/link_stiffness.h"
#include "multibody/formulations/penalty_passes.h"
#include "multibody/formulations/stops.h"

namespace slew::multibody {

namespace {

// every pair of links between which the matrix has a block
std::vector<std::pair<int, int>> coupled_links(const Model& model, std::span<const Constraint> constraints) {
  std::set<std::pair<int, int>> pairs;
  const auto couple = [&pairs](int link1, int link2) {
    if (link1 > 0 && link2 > 0 && link1 != link2) pairs.insert(std::minmax(link1 - 1, link2 - 1));
  };
  for (const Constraint& constraint : constraints) couple(constraint.link1, constraint.link2);
  for (const Gear& gear : model.gears) {
    const std::vector<int> links = links_of(model, gear);
    for (const int link1 : links) {
      for (const int link2 : links) couple(link1, link2);
    }
  }
  for (const CoupledMass& mass : model.coupled) {
    const LineElement& line = model.lines[static_cast<std::size_t>(mass.line)];
    couple(line.link1, line.link2);
  }
  // elements may get constants while running
  for_each_coupling(model, couple);
  return {pairs.begin(), pairs.end()};
}

}  // namespace

double moving_mass(const Model& model) noexcept {
  double mass = 0;
  for (std::size_t i = 1; i < model.links.size(); ++i) mass += model.links[i].mass;
  for (const CoupledMass& coupled : model.coupled) mass += coupled.m1 + coupled.m2;
  // a body whose frame is fixed to Ground moves in its modes alone
  for (const FlexiblePart& part : model.parts) {
    if (part.link == 0 && part.modes > 0) mass += part.source->mass;
  }
  return mass;
}

double penalty_length(const Model& model, std::span<const Constraint> constraints) noexcept {
  double square = 0;
  for (std::size_t i = 1; i < model.links.size(); ++i) {
    const Link& link = model.links[i];
    const double polar = 0.5 * (link.I_L(0, 0) + link.I_L(1, 1) + link.I_L(2, 2));
    if (link.mass > 0) square = std::max(square, polar / link.mass);
  }
  for (const Constraint& constraint : constraints) {
    if (constraint.link1 > 0) square = std::max(square, dot(constraint.p_L1, constraint.p_L1));
    if (constraint.link2 > 0) square = std::max(square, dot(constraint.p_L2, constraint.p_L2));
  }
  // point masses at their joints: any length is valid
  return square > 0 ? std::sqrt(square) : 1.0;
}

PenaltyModel build_penalty_model(const Model& model, Formulation formulation, std::span<const Constraint> more) {
  SLEW_CHECK(formulation == Formulation::augmented || formulation == Formulation::penalty);
  PenaltyModel body;
  body.formulation = formulation;
  body.bodies = build_body_model(model);
  for (const Constraint& joint : body.bodies.joints) {
    if (!joint.rows.empty()) body.constraints.push_back(joint);
  }
  body.constraints.insert(body.constraints.end(), more.begin(), more.end());
  body.length = penalty_length(model, body.constraints);
  const double length = body.length;
  const double alpha = model.penalty.factor * moving_mass(model);
  for (const Constraint& constraint : body.constraints) {
    body.first_row.push_back(static_cast<int>(body.alpha.size()));
    for (const ConstraintRow& row : constraint.rows) {
      body.alpha.push_back(is_angle(row.form) ? alpha * length * length : alpha);
    }
  }
  body.first_row.push_back(static_cast<int>(body.alpha.size()));
  for (const Gear& gear : model.gears) {
    // the row's contribution to either coordinate stays within alpha
    double inertia = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < 2; ++k) {
      const double own = is_angle(gear.kind, k) ? alpha * length * length : alpha;
      const double square = gear.ends[k].factor * gear.ends[k].factor;
      if (square > 0) inertia = std::min(inertia, own / square);
    }
    body.alpha.push_back(inertia);
  }
  body.pattern.nodes.resize(model.links.size() - 1, {kBody, math::BlockKind::definite});
  body.pattern.couplings = coupled_links(model, body.constraints);
  body.modal = add_modal_blocks(model, math::BlockKind::definite, body.pattern);
  std::size_t first = 0;
  for (const Constraint& constraint : body.constraints) {
    PenaltyModel::ModalRows& rows = body.modal_rows.emplace_back();
    if (constraint.node < 0) continue;
    const auto part = static_cast<std::size_t>(model.nodes[static_cast<std::size_t>(constraint.node)].part);
    rows = {first, kBody * (model.links.size() - 1) + modal_place(model, part), model.parts[part].modes};
    first += constraint.rows.size() * rows.modes;
  }
  return body;
}

PenaltyWorkspace::PenaltyWorkspace(const Model& model, const PenaltyModel& body) : ldl(body.pattern) {
  const std::size_t links = model.links.size() - 1, modes = mode_count(model), speeds = 6 * links + modes;
  const std::size_t row_count = body.alpha.size();
  rows.resize(row_count);
  factored.resize(row_count);
  gears.resize(model.gears.size());
  factored_gears.resize(model.gears.size());
  for (std::size_t i = 0; i < body.constraints.size(); ++i) {
    modal.resize(modal.size() + body.constraints[i].rows.size() * body.modal_rows[i].modes);
  }
  factored_modal = modal;
  for (auto* by_row : {&target, &free_multipliers, &multipliers, &no_target, &rates}) by_row->resize(row_count);
  for (auto* by_u : {&force, &correction, &free, &udot, &end_udot, &displacement, &row_displacement,
                     &trapezoid_displacement, &last_correction}) {
    by_u->resize(speeds);
  }
  if (body.formulation == Formulation::penalty) determinants.resize(body.pattern.nodes.size());
  responses.resize(model.rows.size() * speeds);
  response_multipliers.resize(model.rows.size() * row_count);
  qdot.resize(7 * links + modes);
  for (BodyState* copy : {&stage, &sum}) {
    copy->q.resize(7 * links + modes);
    copy->u.resize(speeds);
  }
  stage_joints = {model.start_q, model.start_u};
  for (auto* by_element : {&stops, &stops_0}) by_element->resize(element_stop_count(model));
  row_force.resize(model.rows.size());
  part_mean.resize(model.rows.size());
  frequency = model.penalty.frequency;
}

Drift drift(const PenaltyWorkspace& pws) noexcept {
  Drift largest;
  for (const RowValue& row : pws.rows) largest.add(row);
  return largest;
}

double longest_penalty_step(double damping_ratio, double frequency) noexcept {
  // |1 + z + z^2/2 + z^3/6 + z^4/24| at z = omega h times the roots of s^2 + 2 xi s + 1, over ever longer steps
  constexpr double kResolution = 1e-3, kLongest = 4;
  const std::complex<double> root = std::sqrt(std::complex<double>(damping_ratio * damping_ratio - 1));
  const std::complex<double> faster = -damping_ratio - root;
  double limit = 0;
  for (double step = kResolution; step < kLongest; step += kResolution) {
    const std::complex<double> z = faster * step;
    if (std::abs(1.0 + z * (1.0 + z * (0.5 + z * (1.0 / 6 + z / 24.0)))) > 1) break;
    limit = step;
  }
  return limit / frequency;
}

bool advance(const Model& model, const PenaltyModel& body, BodyState& state, State& joints, Workspace& ws,
             PenaltyWorkspace& pws, double h, std::span<const double> mean, std::span<const double> slope) noexcept {
  if (body.formulation == Formulation::penalty) {
    return advance_by_runge_kutta(model, body, state, joints, ws, pws, h, mean, slope);
  }
  return advance_by_trapezoid(model, body, state, joints, ws, pws, h, mean, slope);
}

}  // namespace slew::multibody
