// SPDX-License-Identifier: Apache-2.0
// scenes/joints/prescribed.yaml follows its laws in every formulation, and its clock starts again with a reset.
#include <gtest/gtest.h>

#include <cmath>

#include "support/mechanics_alone.h"

namespace slew::testing {
namespace motion_scenes_test {

class PrescribedScene : public ::testing::TestWithParam<const char*> {
 protected:
  static MechanicsAlone load() {
    return MechanicsAlone("scenes/joints/prescribed.yaml", {std::string("mechanics.formulation=") + GetParam()});
  }
};

TEST_P(PrescribedScene, FollowsRampSineAndTable) {
  MechanicsAlone m = load();
  const bool is_penalty = std::string(GetParam()) == "penalty";
  const double tolerance = is_penalty ? 1e-5 : 1e-8, swing = M_PI / 9;
  for (const double time : {0.7, 1.5, 2.0, 3.0, 5.0}) {
    m.run_to(time);
    EXPECT_FALSE(m.report.has(StepFlag::not_converged)) << time;
    const double tau = std::min(1.0, (time - 0.5) / 2);
    EXPECT_NEAR(m.value("Slew.position"), M_PI / 2 * tau * tau * tau * (10 - 15 * tau + 6 * tau * tau), tolerance);
    EXPECT_NEAR(m.value("Shoulder.position"), swing * (std::cos(0.8 * M_PI * time) - 1), tolerance);
    if (time == 2.0) {
      EXPECT_NEAR(m.value("Extension.position"), 0.1, tolerance);
    }
    if (time >= 3.0) {
      EXPECT_NEAR(m.value("Extension.position"), 0.6, tolerance);
    }
    EXPECT_NEAR(m.value("Extension_Table.power"),
                m.value("Extension_Table.force") * m.value("Extension_Table.velocity"), 1e-9);
  }
}

TEST_P(PrescribedScene, StartsTheClockAgain) {
  MechanicsAlone m = load();
  m.run_to(0.9);
  const std::uint64_t first = m.subsystem.state_hash();
  m.run_to(1.3);
  m.subsystem.reset();
  m.start();
  m.run_to(0.9);
  EXPECT_EQ(m.subsystem.state_hash(), first);
}

INSTANTIATE_TEST_SUITE_P(Formulations, PrescribedScene,
                         ::testing::Values("recursive", "lagrange", "augmented", "penalty"),
                         [](const auto& test) { return std::string(test.param); });

// A crank of 1 m on a coupler of 0.5 m and a rocker of 0.6 m over 1 m cannot turn beyond 2 asin(1.1/2) = 66.7 degrees,
// which its drive passes at 0.445 s.
TEST(DrivenLoop, PastItsDeadCentreEndsWithTheNameOfTheMotion) {
  for (const char* formulation : {"recursive", "lagrange", "augmented", "penalty"}) {
    MechanicsAlone m("tests/validation/mechanics_node/driven_past_dead_centre.yaml",
                     {std::string("mechanics.formulation=") + formulation});
    m.run_to(0.44);
    EXPECT_FALSE(m.report.has_failed()) << formulation;
    m.run_to(0.6);
    ASSERT_TRUE(m.report.has_failed()) << formulation;
    const std::string text(m.subsystem.failure_text());
    EXPECT_NE(text.find("past which it cannot follow the motion Turn"), std::string::npos) << formulation << text;
  }
}

}  // namespace motion_scenes_test
}  // namespace slew::testing
