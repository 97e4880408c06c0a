// SPDX-License-Identifier: Apache-2.0
// Integrators under the formulations that have a choice of them. The gate takes each rule in joint coordinates and some
// in body coordinates; the instantiation `Nightly` takes the rest.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <tuple>
#include <vector>

#include "tests/validation/multibody/mechanism.h"

namespace slew::multibody::testing {

using Choice = std::tuple<Formulation, Integrator>;
using Rules = std::vector<Integrator>;

inline std::vector<Choice> gate_choices(const Rules& rules, const Rules& in_body_coordinates) {
  std::vector<Choice> choices;
  for (const Integrator rule : rules) choices.emplace_back(Formulation::recursive, rule);
  for (const Integrator rule : in_body_coordinates) choices.emplace_back(Formulation::lagrange, rule);
  return choices;
}

inline std::vector<Choice> nightly_choices(const Rules& rules, const Rules& in_body_coordinates) {
  std::vector<Choice> choices;
  for (const Integrator rule : rules) {
    const bool is_in_gate = std::ranges::find(in_body_coordinates, rule) != in_body_coordinates.end();
    if (!is_in_gate) choices.emplace_back(Formulation::lagrange, rule);
  }
  return choices;
}

inline const auto kChoiceName = [](const ::testing::TestParamInfo<Choice>& tested) {
  return name_of(std::get<0>(tested.param)) + "_" + name_of(std::get<1>(tested.param));
};

}  // namespace slew::multibody::testing
