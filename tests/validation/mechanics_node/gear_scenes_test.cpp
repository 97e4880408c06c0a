// SPDX-License-Identifier: Apache-2.0
// scenes/joints/gears.yaml: a motor, a pair of gears, a drum and two slides that go out together, in every formulation.
#include <gtest/gtest.h>

#include <cmath>

#include "support/mechanics_alone.h"

namespace slew::testing {
namespace gear_scenes_test {

class GearScene : public ::testing::TestWithParam<const char*> {};

TEST_P(GearScene, LiftsTwoStagesByTheTurnsOfItsMotor) {
  MechanicsAlone m("scenes/joints/gears.yaml", {std::string("mechanics.formulation=") + GetParam()});
  const double tolerance = std::string(GetParam()) == "penalty" ? 1e-5 : 1e-8;
  for (const double time : {1.0, 2.0, 4.5}) {
    m.run_to(time);
    EXPECT_FALSE(m.report.has(StepFlag::not_converged)) << time;
    const double tau = std::min(1.0, time / 4), pinion = -40 * tau * tau * tau * (10 - 15 * tau + 6 * tau * tau);
    EXPECT_NEAR(m.value("Drum_Axis.position"), -0.2 * pinion, 10 * tolerance);
    EXPECT_NEAR(m.value("Slide_1.position"), -0.05 * pinion, tolerance);
    EXPECT_NEAR(m.value("Slide_2.position"), -0.05 * pinion, tolerance);
  }
  // at rest: the second stage hangs on the first and on the rope, which lifts it twice as fast
  constexpr double g = 9.81;
  EXPECT_NEAR(m.value("Pull.force_2"), 50 * g, 1e-3);
  EXPECT_NEAR(m.value("Rope.force_2"), (80 + 2 * 50) * g, 1e-2);
  EXPECT_NEAR(m.value("Reduction.torque_2"), (80 + 2 * 50) * g * 0.25, 1e-2);
  EXPECT_NEAR(m.value("Motor.torque"), -(80 + 2 * 50) * g * 0.05, 1e-2);
}

INSTANTIATE_TEST_SUITE_P(Formulations, GearScene, ::testing::Values("recursive", "lagrange", "augmented", "penalty"),
                         [](const auto& tested) { return std::string(tested.param); });

}  // namespace gear_scenes_test
}  // namespace slew::testing
