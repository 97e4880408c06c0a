// SPDX-License-Identifier: Apache-2.0
// A random mechanism in motion under any formulation: a tree for every third seed, one with loops for the others.
#pragma once

#include <random>

#include "multibody/constraints/loops.h"
#include "tests/properties/multibody/random_loops.h"
#include "tests/validation/multibody/mechanism.h"

namespace slew::multibody::testing {

inline MechanicsDef random_mechanism(unsigned seed) {
  if (seed % 3 != 0) return random_loops(seed).def;
  return random_tree(seed, {.bodies = 2 + static_cast<int>(seed) % 6, .two_coordinates = true}).def;
}

// Random speeds that the loops allow, up to about `size` [rad/s, m/s].
inline void set_random_speeds(Mechanism& mechanism, unsigned seed, double size) {
  State& state = mechanism.state;
  std::mt19937 random(seed + 5000);
  for (double& speed : state.u) speed = std::uniform_real_distribution<double>(-size, size)(random);
  if (!mechanism.model.cuts.empty()) {
    forward_dynamics(mechanism.model, state.q, state.u, {}, mechanism.ws);
    ASSERT_TRUE(project(mechanism.model, state.q, state.u, mechanism.ws));
  }
  mechanism.see();
}

// From a state that was changed since the start.
inline void restart(Formulated& mechanism, const MechanicsDef& def) {
  mechanism.dynamics = Dynamics(def.formulation, mechanism.model, mechanism.state, step_rule(def));
  mechanism.see();
}

}  // namespace slew::multibody::testing
