// SPDX-License-Identifier: Apache-2.0
// The mechanics' copy of a cylinder's force is the partner's spring at the stroke that the mechanism has reached.
// Without leakage and damping,
//   F(t + H) = F + F_dot H - K (x(t + H) - x_ref - v_ref H)
// holds without any error of integration, however far the mechanism's way differs from that of the port problem, and
// after every number of sub-steps.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "tests/support/crane_pair.h"

namespace slew::coupling::test {
namespace partner_spring_test {

using testing::CranePair;

// relative to the force; the sums round at 1e-13 of K x
constexpr double kTolerance = 1e-10;

TEST(PartnerSpring, IsTakenAtTheStrokeOfTheMechanism) {
  for (const char* substep : {"1 ms", "0.5 ms", "0.25 ms"}) {
    SCOPED_TRACE(substep);
    const scene::Scene scene = CranePair::load({std::string("mechanics.max_substep=") + substep});
    CranePair crane(scene);
    crane.start();
    double farthest = 0;
    for (int k = 0; k < 400; ++k) {
      ActuatorSample& partner = crane.hydraulics_now.actuators;
      if (k >= 200) {
        ASSERT_TRUE(partner.K_cross.empty());
        for (std::size_t i = 0; i < partner.F.size(); ++i) partner.lambda[i] = partner.D[i] = 0;
      }
      const ActuatorSample used = partner;
      crane.step(CranePair::levers(crane.n));
      const MechanismSample& moved = crane.mechanics_now.mechanism;
      for (std::size_t i = 0; i < used.F.size() && k >= 200; ++i) {
        const double H = 1e-3, way = moved.x[i] - used.x_ref[i] - used.v_ref[i] * H;
        const double F = used.F[i] + used.F_dot[i] * H - used.K[i] * way;
        ASSERT_NEAR(moved.F_used[i], F, kTolerance * std::fabs(F)) << "port " << i << ", step " << k;
        farthest = std::max(farthest, std::fabs(F - used.F[i]) / std::fabs(F));
      }
    }
    EXPECT_GT(farthest, 1e-3) << "the springs were not used";
  }
}

}  // namespace partner_spring_test
}  // namespace slew::coupling::test
