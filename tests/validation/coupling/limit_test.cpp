// SPDX-License-Identifier: Apache-2.0
// A boom inside a joint limit behind the port: what the mechanics publishes about it, and what the coupling makes of
// it.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "build_paths.h"
#include "mechanics_node/mechanics_subsystem.h"
#include "tests/validation/coupling/coupled_run.h"

namespace slew::coupling::test {
namespace limit_test {

scene::Scene load(const std::string& file, const scene::Overrides& overrides) {
  return scene::load_file(std::string(SLEWRING_SOURCE_DIR) + "/scenes/" + file, overrides);
}

constexpr double kLimit = 0.1;  // rad

// the boom without pressure force, 10 um of the port's way inside its limit, at 0.05 rad/s into it
struct FreeBoom {
  explicit FreeBoom(SimDuration H)
      : scene(load("single_cylinder.yaml",
                   {"Ground_Boom.limit_min=-1 rad", "Ground_Boom.limit_max=0.1 rad",
                    "Ground_Boom.limit_stiffness=2e7 Nm/rad", "session.step=" + std::to_string(H.ns / 1000) + " us"})),
        mechanics(scene) {
    mechanics.mutable_state().q[0] = kLimit + 1e-5;
    mechanics.mutable_state().u[0] = 0.05;
    resize(nothing, 1);
    EXPECT_TRUE(mechanics.first_sample(sample));
    EXPECT_TRUE(mechanics.start({nullptr, &nothing}, sample).is_ok());
  }
  double speed_after(int steps) {
    for (int n = 0; n < steps; ++n) mechanics.step(n, {nullptr, &nothing}, {}, sample);
    return sample.mechanism.v[0];
  }

  scene::Scene scene;
  mechanics_node::MechanicsSubsystem mechanics;
  ActuatorSample nothing;
  OwnSample sample;
};

TEST(JointLimit, published_free_acceleration_is_the_mean_over_the_step) {
  for (const auto& [H, tolerance] : {std::pair{milliseconds(1), 2e-3}, {milliseconds(5), 0.05}}) {
    FreeBoom boom(H);
    const double published = boom.sample.mechanism.a_free[0], before = boom.sample.mechanism.v[0];
    FreeBoom fine({10'000});
    const double mean = (fine.speed_after(static_cast<int>(H.ns / 10'000)) - before) / H.seconds();
    // at 1 ms the limit's spring along the way is 0.017 m/s2 of it, at 5 ms 0.084 m/s2
    EXPECT_NEAR(published, mean, tolerance) << H.seconds();
  }
}

TEST(JointLimit, lifting_into_it_keeps_to_the_monolith) {
  scene::Scene scene =
      load("truck_crane.yaml", {"Pillar_LiftBoom.limit_max=20 deg", "Pillar_LiftBoom.limit_damping=0 Nms/rad"});
  constexpr double kDuration = 5;
  constexpr std::size_t kLift = 1;
  const Traces reference = reference_traces(scene, kDuration);
  const Comparison fine = compare(scene, 1e-3, Level::two, reference, kDuration);
  EXPECT_FALSE(fine.has_failed);
  EXPECT_TRUE(fine.flags & static_cast<std::uint32_t>(StepFlag::limit_hit));
  EXPECT_LT(fine.ports[kLift].F, 1e-4 * fine.ports[kLift].F_range);
  const Comparison coarse = compare(scene, 5e-3, Level::two, reference, kDuration);
  EXPECT_LT(coarse.ports[kLift].F, 5e-4 * coarse.ports[kLift].F_range);
}

}  // namespace limit_test
}  // namespace slew::coupling::test
