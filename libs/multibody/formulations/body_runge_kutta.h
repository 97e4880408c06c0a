// SPDX-License-Identifier: Apache-2.0
// The fourth-order Runge-Kutta step of body coordinates, for every method to find their accelerations. Internal to the
// library.
#pragma once

#include <span>

#include "multibody/contacts/contact_passes.h"
#include "multibody/formulations/body_attitude.h"

namespace slew::multibody {

// Starts from accelerations in work.udot; find(state) writes those of a stage there, with the rows' forces in
// work.row_force. work: BodyWorkspace or PenaltyWorkspace. The new state has unit quaternions. False if find() failed
// in a stage.
template <typename Work, typename Find>
[[nodiscard]] bool step_by_runge_kutta(const Model& model, BodyState& state, State& joints, Workspace& ws, Work& work,
                                       double h, std::span<const double> mean, std::span<const double> slope,
                                       Find find) noexcept {
  constexpr double kStageTime[4] = {0, 0.5, 0.5, 1.0};
  constexpr double kWeight[4] = {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6};
  find_rates(state, work.qdot);
  work.sum.q = state.q;
  work.sum.u = state.u;
  work.stage_joints.q = joints.q;
  bool is_sound = true;
  for (int stage = 0; stage < 4; ++stage) {
    if (stage > 0) {
      const double time = kStageTime[stage] * h;
      combine(state.q, time, work.qdot, work.stage.q);
      combine(state.u, time, work.udot, work.stage.u);
      for (std::size_t k = 0; k < mean.size(); ++k) work.row_force[k] = mean[k] + (time - 0.5 * h) * slope[k];
      set_stage_time(model, joints, time, ws);
      is_sound = find(work.stage) && is_sound;
      find_rates(work.stage, work.qdot);
    }
    combine(work.sum.q, h * kWeight[stage], work.qdot, work.sum.q);
    combine(work.sum.u, h * kWeight[stage], work.udot, work.sum.u);
  }
  state.q.swap(work.sum.q);
  state.u.swap(work.sum.u);
  joints.time += h;
  normalize_attitudes(state);
  return is_sound;
}

}  // namespace slew::multibody
