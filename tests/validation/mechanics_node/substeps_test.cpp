// SPDX-License-Identifier: Apache-2.0
// Sub-steps inside of the communication step: every integrator of every formulation.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "multibody/formulations/integrators.h"
#include "multibody/model/field_tables.h"
#include "support/mechanics_alone.h"

namespace slew::testing {
namespace substeps_test {

using multibody::Formulation;
using multibody::Integrator;

// a spatial loop, and a rail with bristles, in sub-steps of 0.5 ms
constexpr const char* kScenes[] = {"scenes/slider_crank.yaml", "scenes/forces/joint_friction.yaml"};

MechanicsAlone alone(const char* scene, Formulation formulation, Integrator integrator, const std::string& step) {
  return MechanicsAlone(scene, {"mechanics.formulation=" + std::string(multibody::key_of(formulation)),
                                "mechanics.integrator=" + std::string(multibody::key_of(integrator)),
                                "mechanics.max_substep=0.0005", "session.step=" + step});
}

class Substeps : public ::testing::TestWithParam<std::pair<Formulation, Integrator>> {};

// The same bits: only the exchange with partners depends on the communication step.
TEST_P(Substeps, OfALongStepAreStepsOfTheirLength) {
  const auto [formulation, integrator] = GetParam();
  for (const char* scene : kScenes) {
    MechanicsAlone fine = alone(scene, formulation, integrator, "0.0005");
    MechanicsAlone coarse = alone(scene, formulation, integrator, "0.002");
    for (int i = 0; i < 25; ++i) {
      std::uint32_t substeps = 0;
      for (int k = 0; k < 4; ++k) {
        fine.step();
        substeps += fine.report.substeps;
      }
      coarse.step();
      EXPECT_GE(coarse.report.substeps, 4U);
      EXPECT_EQ(coarse.report.substeps, substeps);
    }
    EXPECT_EQ(coarse.subsystem.state().q, fine.subsystem.state().q) << scene;
    EXPECT_EQ(coarse.subsystem.state().u, fine.subsystem.state().u) << scene;
  }
}

std::vector<std::pair<Formulation, Integrator>> every_rule() {
  std::vector<std::pair<Formulation, Integrator>> rules;
  for (const Formulation formulation :
       {Formulation::recursive, Formulation::lagrange, Formulation::augmented, Formulation::penalty}) {
    for (const Integrator integrator : multibody::integrators_of(formulation)) {
      rules.emplace_back(formulation, integrator);
    }
  }
  return rules;
}

INSTANTIATE_TEST_SUITE_P(In, Substeps, ::testing::ValuesIn(every_rule()), [](const auto& tested) {
  return std::string(multibody::key_of(tested.param.first)) + "_" + std::string(multibody::key_of(tested.param.second));
});

}  // namespace substeps_test
}  // namespace slew::testing
