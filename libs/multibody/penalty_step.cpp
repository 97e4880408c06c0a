// The Runge-Kutta step of the formulation `penalty`.
#include <cmath>

#include "multibody/body_attitude.h"
#include "multibody/contact_passes.h"
#include "multibody/penalty_passes.h"

namespace slew::multibody {

namespace {

// accelerations of a stage, in pws.udot
bool find_accelerations(const Model& model, const PenaltyModel& body, std::span<const double> forces, Workspace& ws,
                        PenaltyWorkspace& pws) noexcept {
  const bool is_regular = prepare(model, body, pws.stage, pws.stage_joints, ws, pws);
  add_row_forces(model, body, pws.stage_joints, ws, forces, pws.ldl, pws.force);
  return solve(model, body, ws, pws, pws.force, pws.target, pws.udot, pws.multipliers) && is_regular;
}

}  // namespace

bool advance_by_runge_kutta(const Model& model, const PenaltyModel& body, BodyState& state, State& joints,
                            Workspace& ws, PenaltyWorkspace& pws, double h, std::span<const double> mean,
                            std::span<const double> slope) noexcept {
  constexpr double kStageTime[4] = {0, 0.5, 0.5, 1.0};
  constexpr double kWeight[4] = {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6};
  const auto forces_at = [&](double t) {
    for (std::size_t k = 0; k < mean.size(); ++k) pws.row_force[k] = mean[k] + (t - 0.5 * h) * slope[k];
  };
  forces_at(0);
  accelerations(model, pws, pws.row_force, pws.udot);
  find_rates(state, pws.qdot);
  pws.sum.q = state.q;
  pws.sum.u = state.u;
  pws.stage_joints.q = joints.q;
  bool is_solved = true;
  for (int stage = 0; stage < 4; ++stage) {
    if (stage > 0) {
      combine(state.q, kStageTime[stage] * h, pws.qdot, pws.stage.q);
      combine(state.u, kStageTime[stage] * h, pws.udot, pws.stage.u);
      forces_at(kStageTime[stage] * h);
      set_stage_time(model, joints, kStageTime[stage] * h, ws);
      is_solved = find_accelerations(model, body, pws.row_force, ws, pws) && is_solved;
      find_rates(pws.stage, pws.qdot);
    }
    combine(pws.sum.q, h * kWeight[stage], pws.qdot, pws.sum.q);
    combine(pws.sum.u, h * kWeight[stage], pws.udot, pws.sum.u);
  }
  state.q.swap(pws.sum.q);
  state.u.swap(pws.sum.u);
  normalize_attitudes(state.q);
  joints.time += h;
  see(model, body, state, joints, ws, pws);
  accept_contacts(model, h, joints, ws);
  return is_solved;
}

}  // namespace slew::multibody
