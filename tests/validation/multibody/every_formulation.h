// SPDX-License-Identifier: Apache-2.0
// A case of the validation in every formulation, and its result beside the stated tolerance.
//
// With SLEWRING_FIGURES set every figure is printed as a row of the tables in docs/validation.
#pragma once

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <string>

#include "multibody/joints/joint_gauge.h"
#include "tests/validation/multibody/mechanism.h"

namespace slew::multibody::testing {

// `stated`: tolerance of the case; `bound`: asserted bound, looser only with a reason in the card.
struct Figure {
  std::string what;  // with its unit
  double reached = 0, stated = 0;
  double bound = stated;
};

inline void expect_figure(const std::string& which, const std::string& setting, const Figure& figure) {
  EXPECT_LE(figure.reached, figure.bound) << which << ", " << setting << ": " << figure.what;
  if (std::getenv("SLEWRING_FIGURES") == nullptr) return;
  std::printf("| %s | %s | %s | %.1e | %.1e%s |\n", which.c_str(), setting.c_str(), figure.what.c_str(), figure.stated,
              figure.reached, figure.reached > figure.stated ? " *" : "");
}

inline std::string in_milliseconds(double step) {
  char text[32];
  std::snprintf(text, sizeof text, "%g ms", step * 1e3);
  return text;
}

// How far the joints of a mechanism stand open, of the poses that its formulation integrates.
inline JointGap opening(Formulated& mechanism) {
  mechanism.dynamics.observe(mechanism.model, mechanism.state, mechanism.ws);
  const JointGap gap = JointGauge(mechanism.model).measure(mechanism.ws);
  mechanism.see();
  return gap;
}

class EveryFormulation : public ::testing::TestWithParam<Formulation> {
 protected:
  [[nodiscard]] static Formulated start(MechanicsDef def, const std::vector<std::string>& rows = {}) {
    def.formulation = GetParam();
    return Formulated(def, rows);
  }
  // Numbers for `penalty`, which the others do not have: a larger factor for smaller errors, a slower pull where rates
  // count (docs/models/multibody_penalty.md).
  [[nodiscard]] static MechanicsDef tuned(MechanicsDef def, double factor, double frequency) {
    if (!is(Formulation::penalty)) return def;
    def.penalty_factor = factor;
    def.penalty_frequency = frequency;
    return def;
  }
  [[nodiscard]] static bool is(Formulation formulation) { return GetParam() == formulation; }
  // second order against fourth
  [[nodiscard]] static int order() { return is(Formulation::augmented) ? 2 : 4; }
  [[nodiscard]] static std::string setting(double step) { return name_of(GetParam()) + ", " + in_milliseconds(step); }
};

inline const auto kEveryFormulation =
    ::testing::Values(Formulation::recursive, Formulation::lagrange, Formulation::augmented, Formulation::penalty);
inline const auto kFormulationName = [](const ::testing::TestParamInfo<Formulation>& tested) {
  return name_of(tested.param);
};

}  // namespace slew::multibody::testing
