// SPDX-License-Identifier: Apache-2.0
// Case D02 through the whole path: a ball of a scene is thrown at the ground and comes back with the scene's
// restitution.
#include <gtest/gtest.h>

#include "scene_cases.h"

namespace slew::multibody {
namespace rebound_test {

using namespace testing;

MechanicsDef ball(double restitution, double stiffness, double height, double speed, double gravity) {
  MechanicsDef def;
  def.gravity = {0, -gravity, 0};
  add_free(def, free_body("Ball", 1, {4e-3, 4e-3, 4e-3}, {0, 0.1 + height, 0}), {0, -speed, 0});
  def.shapes = {ball_shape("Skin", "Ball", 0.1), ground_shape("Floor")};
  def.contacts = {pair_of("Skin", "Floor", {.stiffness = stiffness, .restitution = restitution})};
  return def;
}

constexpr double kRestitutions[] = {0.1, 0.5, 0.9};

class Rebound : public EveryWay {};
INSTANTIATE_TEST_SUITE_P(D02, Rebound, ::testing::ValuesIn(gate_ways()), name_of_way);
INSTANTIATE_TEST_SUITE_P(D02Nightly, Rebound, ::testing::ValuesIn(nightly_ways()), name_of_way);

// no gravity, 3 m/s, k = 1e5 N/m: contact of about 10 ms; 0.02 ms resolve the damping of e = 0.1 at the onset
TEST_P(Rebound, SpeedIsTheRestitutionOfTheScene) {
  for (const double e : kRestitutions) {
    SCOPED_TRACE("restitution " + std::to_string(e));
    MechanicsDef def = ball(e, 1e5, 0.0123, 3, 0);
    def.contact_substep = 2e-5;
    Motion motion(def, GetParam());
    motion.run(0.1, 1e-3);
    const double rebound = motion.pose("Ball").velocity[1] / 3;
    RecordProperty("rebound_error_1e_6_of_" + std::to_string(std::lround(100 * e)),
                   std::to_string(1e6 * (rebound - e)));
    EXPECT_NEAR(rebound, e, 1e-3);
    EXPECT_TRUE(motion.is_sound);
  }
}

// the error falls with the sub-step, at least in proportion
void expect_error_falls(const Way& way, double e) {
  double errors[2];
  for (int i = 0; i < 2; ++i) {
    MechanicsDef def = ball(e, 1e5, 0.0123, 3, 0);
    def.contact_substep = i == 0 ? 1e-4 : 2.5e-5;
    Motion motion(def, way);
    motion.run(0.1, 1e-3);
    errors[i] = std::fabs(motion.pose("Ball").velocity[1] / 3 - e);
  }
  const std::string percent = std::to_string(std::lround(100 * e));
  ::testing::Test::RecordProperty("error_100us_of_" + percent, std::to_string(errors[0]));
  ::testing::Test::RecordProperty("error_25us_of_" + percent, std::to_string(errors[1]));
  if (way.integrator == Integrator::rk4) {
    EXPECT_LT(errors[1], errors[0] / 4 + 1e-6);
    return;
  }
  // the parts in which it touches and leaves are taken with the implicit Euler rule: an error in proportion to them,
  // larger or smaller by where in them that happens
  constexpr double kPerPart = 4;  // 1/s
  EXPECT_LT(errors[0], kPerPart * 1e-4);
  EXPECT_LT(errors[1], kPerPart * 2.5e-5);
}

TEST_P(Rebound, ErrorFallsWithTheSubstep) {
  for (const double e : kRestitutions) {
    SCOPED_TRACE("restitution " + std::to_string(e));
    expect_error_falls(GetParam(), e);
  }
}

class Bounces : public EveryWay {};
INSTANTIATE_TEST_SUITE_P(D02, Bounces, ::testing::ValuesIn(gate_ways()), name_of_way);
INSTANTIATE_TEST_SUITE_P(D02Nightly, Bounces, ::testing::ValuesIn(nightly_ways()), name_of_way);

// gravity on, k = 1e8 N/m: the case allows 1 % of e, that is 2 % of an apex and 4 % of the second one
TEST_P(Bounces, ReachTheApexesOfTheIdealBall) {
  Motion motion(contact_scene("bouncing_ball"), GetParam());
  const double times[] = {0.4515236 + 0.2257618, 0.9030473 + 0.1128809}, apexes[] = {0.25, 0.0625};
  double t = 0;
  for (int i = 0; i < 2; ++i) {
    motion.run(times[i] - t, 1e-4);
    t = times[i];
    const double apex = motion.pose("Ball").position[1] - 0.1;
    RecordProperty("apex_error_percent_" + std::to_string(i), std::to_string(100 * (apex / apexes[i] - 1)));
    EXPECT_NEAR(apex, apexes[i], 0.02 * (i + 1) * apexes[i]);
  }
  EXPECT_TRUE(motion.is_sound);
}

// e = 1: the springs return their energy; deepest point of the drop from 1 m
TEST(ElasticBall, KeepsItsEnergy) {
  MechanicsDef def = ball(1, 1e5, 1, 0, 9.81);
  def.contact_substep = 2e-5;
  Motion motion(def);
  const double energy = motion.total_energy();
  double deepest = 0, largest = 0;
  for (int i = 0; i < 10000; ++i) {
    motion.step(1e-4);
    motion.see();
    deepest = std::max(deepest, motion.value("Skin_Floor.depth"));
    largest = std::max(largest, std::fabs(motion.total_energy() - energy));
  }
  EXPECT_LT(largest, 1e-4 * energy);
  EXPECT_NEAR(deepest, 1.4105584557e-2, 1e-3 * 1.41e-2);
}

}  // namespace rebound_test
}  // namespace slew::multibody
