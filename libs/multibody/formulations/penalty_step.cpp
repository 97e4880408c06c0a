// SPDX-License-Identifier: Apache-2.0
// The Runge-Kutta step of the formulation `penalty`, in parts near singular positions: (9) of body_penalty.h.
#include <algorithm>
#include <cmath>

#include "multibody/constraints/loops.h"
#include "multibody/formulations/body_runge_kutta.h"
#include "multibody/formulations/penalty_passes.h"

namespace slew::multibody {

namespace {

// c and omega times part of (9): measured on A02 with 1 to 40 loops. Larger ones lose energy in a flat position, the
// second by how fast a row closes, both by the error of the Runge-Kutta method.
constexpr double kMostChange = 0.1, kPartFrequency = 0.2;
// Limit for whole steps: the whip of A11's chain exceeds 0.4, without any such position.
constexpr double kMostChangeOfAStep = 0.4;
// Parts of a step that are shorter than this share close faster; that whip needs none.
constexpr int kClosingParts = 32;
// smallest part of a step, and the number of halved parts before the rest stays unresolved
constexpr int kSmallestParts = 65536, kMostHalvings = 512;

void keep_determinants(PenaltyWorkspace& pws) noexcept {
  for (std::size_t node = 0; node < pws.determinants.size(); ++node) {
    pws.determinants[node] = pws.ldl.root_of_determinant(static_cast<int>(node));
  }
}

void see_change(PenaltyWorkspace& pws) noexcept {
  for (std::size_t node = 0; node < pws.determinants.size(); ++node) {
    const double ratio = pws.ldl.root_of_determinant(static_cast<int>(node)) / pws.determinants[node];
    const double change = std::fabs(std::log(ratio));
    if (!(change <= pws.change)) pws.change = change;  // NaN stays
  }
}

// accelerations of a stage, in pws.udot
bool find_accelerations(const Model& model, const PenaltyModel& body, std::span<const double> forces, Workspace& ws,
                        PenaltyWorkspace& pws) noexcept {
  const bool is_regular = prepare(model, body, pws.stage, pws.stage_joints, ws, pws);
  see_change(pws);
  add_row_forces(model, body, pws.stage_joints, ws, forces, pws.ldl, pws.force);
  const bool is_solved = solve(model, body, ws, pws, pws.force, pws.target, pws.udot, pws.multipliers);
  if (ws.hold != nullptr) answer_rows(model, body.bodies, pws.stage_joints, pws.ldl, pws.responses, ws, pws.udot);
  return is_solved && is_regular;
}

// keeps the previous state in pws.sum
bool take_part(const Model& model, const PenaltyModel& body, BodyState& state, State& joints, Workspace& ws,
               PenaltyWorkspace& pws, double h, std::span<const double> slope) noexcept {
  for (std::size_t k = 0; k < slope.size(); ++k) pws.row_force[k] = pws.part_mean[k] - 0.5 * h * slope[k];
  keep_determinants(pws);
  pws.change = 0;
  accelerations(model, pws, pws.row_force, pws.udot);
  if (ws.hold != nullptr) answer_rows(model, body.bodies, joints, pws.ldl, pws.responses, ws, pws.udot);
  return step_by_runge_kutta(model, state, joints, ws, pws, h, pws.part_mean, slope,
                             [&](const BodyState&) { return find_accelerations(model, body, pws.row_force, ws, pws); });
}

// before the next part, with this number of smallest ones
bool begin_part(const Model& model, const PenaltyModel& body, const BodyState& state, State& joints, Workspace& ws,
                PenaltyWorkspace& pws, double h, int part) noexcept {
  const double least = part <= kSmallestParts / kClosingParts ? kPartFrequency * kSmallestParts / (part * h) : 0;
  pws.frequency = std::max(model.penalty.frequency, least);
  return evaluate(model, body, state, joints, ws, pws);
}

}  // namespace

bool advance_by_runge_kutta(const Model& model, const PenaltyModel& body, BodyState& state, State& joints,
                            Workspace& ws, PenaltyWorkspace& pws, double h, std::span<const double> mean,
                            std::span<const double> slope) noexcept {
  bool is_sound = true;
  int halvings = 0;
  for (int done = 0, part = kSmallestParts; done < kSmallestParts;) {
    // the rows' forces continue along their lines
    const double share = static_cast<double>(part) / kSmallestParts;
    const double later = h * (static_cast<double>(done) / kSmallestParts + 0.5 * share - 0.5);
    for (std::size_t k = 0; k < mean.size(); ++k) pws.part_mean[k] = mean[k] + later * slope[k];
    const double time = joints.time;
    const bool is_solved = take_part(model, body, state, joints, ws, pws, share * h, slope);
    const bool is_resolved = pws.change <= (part == kSmallestParts ? kMostChangeOfAStep : kMostChange);
    if (!is_resolved && part > 1 && halvings < kMostHalvings && std::isfinite(pws.change)) {
      ++halvings;
      state.q.swap(pws.sum.q);
      state.u.swap(pws.sum.u);
      joints.time = time;
      part /= 2;
      is_sound = begin_part(model, body, state, joints, ws, pws, h, part) && is_sound;
      continue;
    }
    is_sound = is_solved && is_resolved && is_sound;
    see(model, body, state, joints, ws, pws);
    accept_contacts(model, share * h, joints, ws);
    done += part;
    if (done % (2 * part) == 0) part *= 2;
    if (done < kSmallestParts) is_sound = begin_part(model, body, state, joints, ws, pws, h, part) && is_sound;
  }
  pws.frequency = model.penalty.frequency;
  return is_sound && drift(pws).position <= kHeldByPenalty * extent_of(ws).length;
}

}  // namespace slew::multibody
