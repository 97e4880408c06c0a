// SPDX-License-Identifier: Apache-2.0
// Case D01 through a scene: a block dragged over a floor by a spring sticks and slips (Canudas de Wit et al. 1995, fig.
// 5), in every formulation. Reference: data/lugre_stick_slip.csv, whose end is the published one of EXUDYN's
// lugreFrictionODE1. Tolerances of the case: position 1e-3 m, onset of slip 0.02 s.
#include <algorithm>

#include "scene_cases.h"
#include "support/nightly.h"
#include "tests/validation/multibody/csv_table.h"

namespace slew::multibody {
namespace stick_slip_test {

using namespace testing;
using slew::testing::rounds;

constexpr double kOnsets[] = {7.46, 13.83, 20.19};

// the whole run with each formulation's own rule, the first slip with the others
double end_of_run(const Way& way) {
  return way.integrator == Integrator::rk4 ? 25.0 : rounds(9.0, 25.0);
}

class StickSlip : public EveryWay {};
INSTANTIATE_TEST_SUITE_P(D01, StickSlip, ::testing::ValuesIn(gate_ways()), name_of_way);
INSTANTIATE_TEST_SUITE_P(D01Nightly, StickSlip, ::testing::ValuesIn(nightly_ways()), name_of_way);

TEST_P(StickSlip, FollowsTheTable) {
  Motion motion(contact_scene("stick_slip"), GetParam());
  const auto table = read_table("lugre_stick_slip.csv");
  std::vector<double> onsets;
  double worst = 0, peak = 0;
  bool slips = false;
  const auto rows = static_cast<std::size_t>(std::lround(end_of_run(GetParam()) / 0.01));
  for (std::size_t row = 1; row <= rows; ++row) {
    for (int i = 0; i < 10; ++i) {
      motion.is_sound = motion.step(1e-3) && motion.is_sound;
      const bool slips_now = motion.state.u[0] > 0.01;
      if (slips_now && !slips) onsets.push_back(table[row - 1][0] + (i + 1) * 1e-3);
      slips = slips_now;
    }
    motion.see();
    peak = std::max(peak, -motion.value("Sides_Floor.friction_force.x"));
    worst = std::max(worst, std::fabs(motion.pose("Block").position[0] - table[row][1]));
  }
  RecordProperty("worst_x_um", std::to_string(worst * 1e6));
  RecordProperty("peak_N", std::to_string(peak));
  EXPECT_TRUE(motion.is_sound);
  EXPECT_LT(worst, 1e-3);
  EXPECT_NEAR(peak, 1.47657, 1e-3 * 1.47657);
  const std::ptrdiff_t expected =
      std::count_if(std::begin(kOnsets), std::end(kOnsets), [&](double t) { return t < end_of_run(GetParam()); });
  ASSERT_EQ(static_cast<std::ptrdiff_t>(onsets.size()), expected);
  for (std::size_t i = 0; i < onsets.size(); ++i) EXPECT_NEAR(onsets[i], kOnsets[i], 0.02);
  if (rows < 2500) return;
  EXPECT_NEAR(motion.pose("Block").position[0], 1.908839199226505, 1e-3);
}

}  // namespace stick_slip_test
}  // namespace slew::multibody
