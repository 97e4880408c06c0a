// SPDX-License-Identifier: Apache-2.0
// Mechanics alone under CVODE against cases A05 and A08: the last digits that the references print.
#include "monolith/mechanics_reference.h"

#include <gtest/gtest.h>

#include <cmath>

#include "multibody/results/observe.h"
#include "tests/validation/multibody/governor_def.h"
#include "tests/validation/multibody/loop_defs.h"

namespace slew::monolith {
namespace mechanics_reference_test {

using multibody::BodyPose;
using multibody::MechanicsDef;

// Reference states of a mechanism, and poses there.
struct Reference {
  Reference(const MechanicsDef& def, std::vector<double> output_times) : times(std::move(output_times)) {
    const Status status = integrate_mechanics(def, times, {}, result);
    EXPECT_TRUE(status.is_ok()) << status.text;
    EXPECT_EQ(result.states.size(), times.size());
  }
  [[nodiscard]] BodyPose pose(const std::string& body, std::size_t output) const {
    multibody::Workspace ws(result.model);
    multibody::observe(result.model, result.states[output], ws);
    return multibody::body_pose(result.model, ws, multibody::find_body(result.model, body));
  }
  [[nodiscard]] double energy(std::size_t output) const {
    multibody::Workspace ws(result.model);
    multibody::observe(result.model, result.states[output], ws);
    const multibody::Energy e = multibody::energy(result.model, ws);
    return e.kinetic + e.potential;
  }

  std::vector<double> times;
  MechanicsReference result;
};

// The table has ten digits and was made to 1e-10 or so; over 5 s errors grow a hundredfold.
TEST(MechanicsReference, SpatialSliderCrankIsThatOfTheTable) {
  const Reference crank(multibody::testing::slider_crank(), {0, 0.2, 0.5, 1, 2, 5});
  constexpr double kPosition[] = {0.2, 0.2630389726, 0.1849526298, 0.2117216614, 0.2890851971, 0.2407195737};
  for (std::size_t i = 0; i < crank.times.size(); ++i) {
    EXPECT_NEAR(crank.pose("Slider", i).position[0], kPosition[i], i < 5 ? 2e-8 : 2e-7) << crank.times[i];
    EXPECT_NEAR(crank.energy(i), crank.energy(0), 1e-7);
  }
  RecordProperty("steps", std::to_string(crank.result.statistics.steps));
}

TEST(MechanicsReference, StiffGovernorIsThatOfTheTable) {
  const Reference governor(multibody::testing::governor_def(), {0.1, 0.5, 1, 2, 5, 10});
  constexpr double kSlider[] = {0.5238364756, 0.7432494248, 0.5014209224, 0.5059092943, 0.5355631037, 0.6196229171};
  for (std::size_t i = 0; i < governor.times.size(); ++i) {
    EXPECT_NEAR(governor.pose("Slider", i).position[2], kSlider[i], 1e-8) << governor.times[i];
  }
}

// through positions in which the loop's rows depend on each other
TEST(MechanicsReference, FourBarPassesItsFlatPositions) {
  const Reference bars(multibody::testing::four_bars(1), {0, 0.5, 1, 1.5, 2});
  double way = 0;
  for (std::size_t i = 0; i < bars.times.size(); ++i) {
    EXPECT_NEAR(bars.energy(i), bars.energy(0), 1e-6 * bars.energy(0));
    way = std::max(way, std::abs(bars.pose("Coupler0", i).position[1] - bars.pose("Coupler0", 0).position[1]));
  }
  EXPECT_GT(way, 1) << "it did not pass";
}

}  // namespace mechanics_reference_test
}  // namespace slew::monolith
