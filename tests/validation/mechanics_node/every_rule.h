// SPDX-License-Identifier: Apache-2.0
// All ways to compute the mechanics of a scene: each formulation with each of its integrators.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "multibody/formulations/integrators.h"

namespace slew::testing {

struct RuleOfScene {
  std::string formulation, integrator;
  [[nodiscard]] std::string keys() const { return "formulation: " + formulation + ", integrator: " + integrator; }
};

inline std::string name_of_rule(const ::testing::TestParamInfo<RuleOfScene>& test) {
  return test.param.formulation + "_" + test.param.integrator;
}

// in the gate: the recursion, and one rule of each kind in the others
inline std::vector<RuleOfScene> gate_rules() {
  return {{"recursive", "rk4"},
          {"recursive", "semi_implicit_euler"},
          {"recursive", "trapezoidal"},
          {"recursive", "generalised_alpha"},
          {"recursive", "sdirk2"},
          {"lagrange", "rk4"},
          {"augmented", "index3_trapezoidal"},
          {"penalty", "rk4"}};
}

inline std::vector<RuleOfScene> nightly_rules() {
  return {{"lagrange", "semi_implicit_euler"},
          {"lagrange", "trapezoidal"},
          {"lagrange", "generalised_alpha"},
          {"lagrange", "sdirk2"}};
}

}  // namespace slew::testing
