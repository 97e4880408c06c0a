// SPDX-License-Identifier: Apache-2.0
// The platform on a telescopic cylinder, split against undivided: two changes of stage on the way up, one on the
// way down.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "build_paths.h"
#include "monolith/monolith.h"
#include "tests/support/crane_pair.h"

namespace slew::monolith {
namespace telescopic_test {

// Lifts from 0.2 s, rests from 7.5 s, lowers from 9 s on, each by a ramp of a second.
double signal(double t) {
  const auto ramp = [t](double begin) { return std::clamp(t - begin, 0.0, 1.0); };
  return ramp(0.2) - ramp(7.5) - 0.6 * ramp(9);
}

TEST(TelescopicCylinder, PlatformAgreesWithTheUndividedMachineAtOneAndFiveMilliseconds) {
  const std::string file = SLEWRING_SOURCE_DIR "/scenes/tipper_telescopic.yaml";
  for (const int step : {1, 5}) {
    const scene::Scene scene = scene::load_file(file, {"session.step=" + std::to_string(step) + " ms"});
    slew::testing::CranePair pair(scene);
    pair.start();
    Monolith monolith(scene);
    ASSERT_TRUE(monolith.start().is_ok());
    EXPECT_NEAR(monolith.ports()[0].F, pair.hydraulics_now.actuators.F[0], 1);
    double worst_x = 0, highest = 0;
    int most = 0, least_after = 3;
    for (std::int64_t k = 0; k * step < 14000; ++k) {
      const double t = 1e-3 * static_cast<double>(k * step);
      const double control[] = {signal(t)};
      pair.step(control);
      ASSERT_TRUE(monolith.advance_to({(k + 1) * step * 1'000'000}, control).is_ok());
      worst_x = std::max(worst_x, std::fabs(pair.mechanics_now.mechanism.x[0] - monolith.ports()[0].x));
      highest = std::max(highest, monolith.ports()[0].x);
      const int stage = static_cast<int>(monolith.variable("Cyl_Tip.stage"));
      most = std::max(most, stage);
      if (t > 9) least_after = std::min(least_after, stage);
    }
    RecordProperty("x_um_" + std::to_string(step), std::to_string(1e6 * worst_x));
    RecordProperty("highest_mm_" + std::to_string(step), std::to_string(1e3 * highest));
    EXPECT_EQ(most, 3);
    EXPECT_LT(least_after, 3);
    EXPECT_LT(worst_x, step == 1 ? 10e-6 : 200e-6);
  }
}

}  // namespace telescopic_test
}  // namespace slew::monolith
