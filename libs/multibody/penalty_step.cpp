// The Runge-Kutta step of the formulation `penalty`.
#include <cmath>

#include "multibody/body_runge_kutta.h"
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
  for (std::size_t k = 0; k < mean.size(); ++k) pws.row_force[k] = mean[k] - 0.5 * h * slope[k];
  accelerations(model, pws, pws.row_force, pws.udot);
  const bool is_solved = step_by_runge_kutta(model, state, joints, ws, pws, h, mean, slope, [&](const BodyState&) {
    return find_accelerations(model, body, pws.row_force, ws, pws);
  });
  see(model, body, state, joints, ws, pws);
  accept_contacts(model, h, joints, ws);
  return is_solved;
}

}  // namespace slew::multibody
