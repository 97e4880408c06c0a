// SPDX-License-Identifier: Apache-2.0
// rk4 beside rows that friction holds: the warning, against what a resting crane with modes does in the run itself.
#include "mechanics_node/held_rows.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "analysis/start_check.h"
#include "build_paths.h"
#include "mechanics_node/mechanics_subsystem.h"
#include "session/direct_session.h"

namespace slew::analysis {
namespace held_rows_test {

scene::Scene load(const std::string& file, const std::string& substep) {
  return scene::load_file(SLEWRING_SOURCE_DIR "/scenes/" + file,
                          {"mechanics.integrator=rk4", "mechanics.max_substep=" + substep});
}

// largest modal speed of a crane that should stay at rest, in the last half of some steps of 1 ms
double modal_speed_at_rest(const scene::Scene& scene, int steps) {
  session::DirectSession session(scene);
  EXPECT_TRUE(session.start().is_ok());
  const auto* mechanics = session.physics<mechanics_node::MechanicsSubsystem>(wire::Role::mechanics);
  const std::vector<double> controls(scene.inputs.size(), 0.0);
  double largest = 0;
  for (int n = 0; n < steps; ++n) {
    session.step(n, {}, controls);
    if (n < steps / 2) continue;
    for (const multibody::FlexiblePart& part : mechanics->model().parts) {
      for (std::size_t k = 0; k < part.modes; ++k) {
        largest = std::max(largest, std::fabs(mechanics->state().u[static_cast<std::size_t>(part.u) + k]));
      }
    }
  }
  return largest;
}

struct Case {
  const char* file;
  const char* substep;
  const char* row;  // that is named; empty: none
};

TEST(HeldRows, AreWarnedOfWhereARestingCraneSwingsByItself) {
  for (const Case& c : std::vector<Case>{{"truck_crane_full.yaml", "0.19 ms", "ForceT_Lift"},
                                         {"truck_crane_full.yaml", "0.15 ms", "ForceT_Lift"},
                                         {"truck_crane_full.yaml", "0.1 ms", ""},
                                         {"forwarder_crane_flexible.yaml", "1 ms", "Lift_Line"},
                                         {"forwarder_crane_flexible.yaml", "0.5 ms", ""}}) {
    const scene::Scene scene = load(c.file, c.substep);
    const auto found = mechanics_node::find_unstable_row(scene);
    const double speed = modal_speed_at_rest(scene, 60);
    const std::string where = std::string(c.file) + " in " + c.substep;
    EXPECT_EQ(found ? found->row : "", c.row) << where;
    // modes at rest creep with the oil, at 1e-3 at most; those that grow end at the friction's bound
    EXPECT_EQ(speed > 0.02, found.has_value()) << where << ": " << speed;
    const std::vector<std::string> warnings = start_warnings(scene);
    const bool is_stated = std::any_of(warnings.begin(), warnings.end(), [&](const std::string& warning) {
      return warning.find("while its friction holds it") != std::string::npos;
    });
    EXPECT_EQ(is_stated, found.has_value()) << where;
  }
}

// in sub-steps of 1/7 ms the speed of the lift cylinder's row was measured to grow from 2.783e-5 to 1.142e-4 m/s in 15
// sub-steps of the run, before its friction's bound is reached
TEST(HeldRows, GrowAsInTheRun) {
  const auto found = mechanics_node::find_unstable_row(load("truck_crane_full.yaml", "0.15 ms"));
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->growth, std::pow(1.142e-4 / 2.783e-5, 1.0 / 15), 2e-3);
}

TEST(HeldRows, AreStableInTheSubStepThatIsNamed) {
  for (const char* substep : {"0.19 ms", "0.15 ms", "0.12 ms"}) {
    const auto found = mechanics_node::find_unstable_row(load("truck_crane_full.yaml", substep));
    ASSERT_TRUE(found) << substep;
    for (const double share : {1.0, 0.9, 0.8, 0.7, 0.6}) {
      const std::string shorter = std::to_string(1e3 * share * found->longest_step) + " ms";
      EXPECT_FALSE(mechanics_node::find_unstable_row(load("truck_crane_full.yaml", shorter))) << shorter;
    }
  }
}

}  // namespace held_rows_test
}  // namespace slew::analysis
