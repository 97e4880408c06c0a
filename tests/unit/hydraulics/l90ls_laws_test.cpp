// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/components/l90ls_laws.h"

#include <gtest/gtest.h>

#include <cmath>

namespace slew::hydraulics {
namespace l90ls_laws_test {

constexpr double kBar = 1e5;

L90Side lift() {
  return {.K_supply = 6.236e-7,
          .K_return = 6.236e-7,
          .K_comp_2 = 2.795e-6 * 2.795e-6,
          .compensator_pressure = 8 * kBar,
          .maximum_ls = 180 * kBar,
          .opening_rise = 1 * kBar,
          .shock_setting = 250 * kBar,
          .shock_rise = 10 * kBar,
          .K_shock = 2e-7,
          .K_anti_cavitation = 2e-6,
          .crack = 0.2 * kBar,
          .transition = 0.1 * kBar};
}

TEST(L90Supply, FallsToZeroWithTheDropWhateverTheLoad) {
  for (double load = 180 * kBar; load < 188 * kBar; load += 0.05 * kBar) {
    const double open = supply(lift(), 1, 10 * kBar, load).Q;
    EXPECT_GT(open, 0) << load;
    EXPECT_LT(supply(lift(), 1, 1, load).Q, 1e-3 * open) << load;
  }
}

TEST(L90Supply, IsClosedByTheCompensatorAboveTheLoadLimit) {
  for (const double drop : {1.0, 0.3 * kBar, 10 * kBar, 60 * kBar}) {
    EXPECT_EQ(supply(lift(), 1, drop, 188 * kBar).Q, 0) << drop;
    EXPECT_EQ(supply(lift(), 1, drop, 200 * kBar).Q, 0) << drop;
  }
}

TEST(L90Supply, MetersTheStatedFlowAwayFromItsSwitches) {
  // 70 l/min at 35 bar with 8 bar held
  EXPECT_NEAR(supply(lift(), 1, 30 * kBar, 100 * kBar).Q * 60000, 70 * std::sqrt(8.0 / 35), 0.01);
  EXPECT_NEAR(supply(lift(), 1, 30 * kBar, 185 * kBar).Q * 60000, 70 * std::sqrt(3.0 / 35), 0.01);
}

TEST(L90Supply, HasTheSlopesOfItsValueAroundTheCorner) {
  // loads and drops at which compensator and lock-hold switch together
  const L90Side side = lift();
  for (double load = 186 * kBar; load < 188.2 * kBar; load += 0.037 * kBar) {
    for (double drop = 0.011 * kBar; drop < 2 * kBar; drop *= 1.3) {
      for (const double opening : {0.1, 1.0}) {
        const SupplyFlow flow = supply(side, opening, drop, load);
        const double h = 1;
        const double d_drop =
            (supply(side, opening, drop + h, load).Q - supply(side, opening, drop - h, load).Q) / (2 * h);
        const double d_load =
            (supply(side, opening, drop, load + h).Q - supply(side, opening, drop, load - h).Q) / (2 * h);
        const double d_opening =
            (supply(side, opening + 1e-6, drop, load).Q - supply(side, opening - 1e-6, drop, load).Q) / 2e-6;
        const double scale = side.K_supply * opening / std::sqrt(side.transition);
        EXPECT_NEAR(flow.d_drop, d_drop, 1e-4 * scale) << load << ' ' << drop;
        EXPECT_NEAR(flow.d_load, d_load, 1e-4 * scale) << load << ' ' << drop;
        EXPECT_NEAR(flow.d_opening, d_opening, 1e-4 * std::fabs(d_opening) + 1e-4 * scale) << load << ' ' << drop;
      }
    }
  }
}

}  // namespace l90ls_laws_test
}  // namespace slew::hydraulics
