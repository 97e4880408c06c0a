// SPDX-License-Identifier: Apache-2.0
// Mechanisms 1e5 m from the origin move as they do there, in every formulation. A double resolves 1.5e-11 m at that
// place. Bounds and figures: docs/extremes.md.
#include "tests/validation/multibody/chain_def.h"
#include "tests/validation/multibody/every_formulation.h"
#include "tests/validation/multibody/extremes/outcome.h"
#include "tests/validation/multibody/loop_defs.h"

namespace slew::multibody {
namespace far_test {

using namespace testing;

constexpr double kFar = 1e5;  // m

MechanicsDef moved(MechanicsDef def, Triple by) {
  const auto move = [&](Triple& point) {
    for (std::size_t k = 0; k < 3; ++k) point[k] += by[k];
  };
  for (BodyDef& body : def.bodies) {
    if (body.relative_to == kGroundName) move(body.position);
  }
  for (JointDef& joint : def.joints) {
    if (joint.body1 == kGroundName) move(joint.point1);
    if (joint.body2 == kGroundName) move(joint.point2);
  }
  return def;
}

class FarOff : public EveryFormulation {
 protected:
  static void expect_same(const std::string& name, const MechanicsDef& def, double time, double step) {
    const Triple by = {kFar, -kFar, kFar};
    Formulated near = start(def), far = start(moved(def, by));
    EXPECT_TRUE(near.try_run(time, step));
    Outcome outcome;
    outcome.is_flagged = !far.try_run(time, step);
    outcome.error = opening(far).position;
    for (const BodyDef& body : def.bodies) {
      const Triple here = near.pose(body.name).center_of_mass, there = far.pose(body.name).center_of_mass;
      double square = 0;
      for (std::size_t k = 0; k < 3; ++k) square += std::pow(there[k] - by[k] - here[k], 2);
      if (!(std::sqrt(square) <= outcome.error)) outcome.error = std::sqrt(square);
    }
    expect_outcome(name + ", 1e5 m off [m]", setting(step), outcome, 1e-6, Ending::right);
  }
};

TEST_P(FarOff, ChainMovesAsAtTheOrigin) {
  expect_same("chain of 10", chain_def({}), 0.5, 1e-3);
}
TEST_P(FarOff, SliderCrankMovesAsAtTheOrigin) {
  expect_same("slider-crank", slider_crank(), 1, 1e-3);
}
TEST_P(FarOff, FourBarMovesAsAtTheOrigin) {
  expect_same("four-bar through flat", four_bars(1), 1, 1e-3);
}

INSTANTIATE_TEST_SUITE_P(In, FarOff, kEveryFormulation, kFormulationName);

}  // namespace far_test
}  // namespace slew::multibody
