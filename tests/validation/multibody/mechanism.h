// SPDX-License-Identifier: Apache-2.0
// A mechanism under test: model, state and workspace of a Def that must be sound.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "multibody/build/validate.h"
#include "multibody/formulations/dynamics.h"
#include "multibody/formulations/formulation.h"
#include "multibody/results/observe.h"

namespace slew::multibody::testing {

inline std::string text_of(const Problems& problems) {
  std::string text;
  for (const Problem& problem : problems)
    text += problem.path + ": " + problem.what + "; expected " + problem.expected + "\n";
  return text;
}

struct Mechanism {
  explicit Mechanism(const MechanicsDef& def, const std::vector<std::string>& rows = {})
      : model((expect_sound(def, rows), build_model(def, rows))), state(start_state(model)), ws(model) {
    see();
  }

  static void expect_sound(const MechanicsDef& def, const std::vector<std::string>& rows) {
    Problems problems;
    validate(def, problems);
    validate_rows(def, rows, problems);
    EXPECT_TRUE(problems.empty()) << text_of(problems);
  }

  // free motion for `time` in steps of h
  void run(double time, double h) {
    const int steps = static_cast<int>(std::lround(time / h));
    for (int i = 0; i < steps; ++i) advance_free(model, state, ws, h);
    see();
  }

  void see() { observe(model, state, ws); }

  [[nodiscard]] BodyPose pose(const std::string& body) const { return body_pose(model, ws, find_body(model, body)); }
  [[nodiscard]] double total_energy() const {
    const Energy e = energy(model, ws);
    return e.kinetic + e.potential;
  }
  [[nodiscard]] double value(const std::string& variable) const {
    const std::vector<ElementVariable> names = variables(model);
    std::vector<double> values(names.size());
    read_variables(model, state, ws, {}, values);
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (names[i].name == variable) return values[i];
    }
    ADD_FAILURE() << "no variable " << variable;
    return 0;
  }

  Model model;
  State state;
  Workspace ws;
};

// The same under the formulation that its Def names.
struct Formulated : Mechanism {
  explicit Formulated(const MechanicsDef& def, const std::vector<std::string>& rows = {})
      : Mechanism(def, rows), dynamics(def.formulation, model, state, step_rule(def)) {}

  void run(double time, double h) { run(time, h, std::vector<double>(model.rows.size())); }
  // under constant forces of the rows
  void run(double time, double h, const std::vector<double>& row_forces) { EXPECT_TRUE(try_run(time, h, row_forces)); }
  // False: a step was flagged.
  [[nodiscard]] bool try_run(double time, double h, const std::vector<double>& row_forces = {}) {
    const int steps = static_cast<int>(std::lround(time / h));
    const std::vector<double> slope(row_forces.size());
    bool is_sound = true;
    for (int i = 0; i < steps; ++i) {
      dynamics.evaluate(model, state, ws);
      is_sound = dynamics.advance(model, state, ws, h, row_forces, slope) && is_sound;
    }
    see();
    return is_sound;
  }

  Dynamics dynamics;
};

inline std::string name_of(Integrator integrator) {
  constexpr const char* kNames[] = {"rk4", "semi_implicit_euler", "trapezoidal", "generalised_alpha", "sdirk2"};
  return kNames[static_cast<int>(integrator)];
}

inline std::string name_of(Formulation formulation) {
  constexpr const char* kNames[] = {"recursive", "lagrange", "augmented", "penalty"};
  return kNames[static_cast<int>(formulation)];
}

}  // namespace slew::multibody::testing
