// SPDX-License-Identifier: Apache-2.0
// A mechanism in body coordinates whose joints are held by penalties, for tests.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "multibody/formulations/body_penalty.h"
#include "multibody/results/observe.h"

namespace slew::multibody::testing {

// A mechanism under one of the formulations that hold joints by penalties, and the largest errors of its joints so far.
struct Held {
  Held(const Model& mechanism, const State& start, Formulation formulation, std::span<const Constraint> more = {})
      : model(mechanism),
        body(build_penalty_model(model, formulation, more)),
        state(body_state(model, start)),
        joints(start),
        ws(model),
        pws(model, body) {}

  [[nodiscard]] bool see() { return evaluate(model, body, state, joints, ws, pws); }
  // row forces mean + (t - h/2) slope in every step
  [[nodiscard]] bool run(int steps, double h, std::span<const double> mean, std::span<const double> slope) {
    bool is_right = true;
    for (int i = 0; i < steps; ++i) {
      is_right = see() && is_right;
      is_right = advance(model, body, state, joints, ws, pws, h, mean, slope) && is_right;
      position_error = std::max(position_error, drift(pws).position);
      rate_error = std::max(rate_error, drift(pws).rate);
      iterations = std::max(iterations, pws.iterations);
    }
    return is_right;
  }
  [[nodiscard]] bool run(int steps, double h) {
    const std::vector<double> none(model.rows.size());
    return run(steps, h, none, none);
  }

  // J, of the motion after the last step
  [[nodiscard]] double total_energy() {
    observe(model, joints, ws);
    const Energy e = energy(model, ws);
    return e.kinetic + e.potential;
  }

  Model model;
  PenaltyModel body;
  BodyState state;
  State joints;
  Workspace ws;
  PenaltyWorkspace pws;
  double position_error = 0, rate_error = 0;
  int iterations = 0;
};

}  // namespace slew::multibody::testing
