// SPDX-License-Identifier: Apache-2.0
// Contact of bodies that move freely: momentum stays, energy does not grow, both formulations agree, for all shapes and
// motions.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "support/nightly.h"
#include "tests/validation/multibody/contact/contact_scene.h"

namespace slew::multibody {
namespace contact_test {

using namespace testing;
using slew::testing::rounds;

class FreeContact : public ::testing::Test {
 protected:
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  Triple direction(double size) { return {uniform(-size, size), uniform(-size, size), uniform(-size, size)}; }

  // a box and a ball on a course to each other, both spinning, without weight
  MechanicsDef pair() {
    MechanicsDef def;
    def.gravity = {};
    def.contact_substep = 5e-5;
    add_free(def, box_body("Box", uniform(0.5, 5), {0.3, 0.4, 0.5}, {0, 0, 0}));
    add_free(def, free_body("Ball", uniform(0.5, 5), {0.02, 0.02, 0.02}, {1, uniform(-0.2, 0.2), uniform(-0.2, 0.2)}),
             {uniform(-4, -1), 0, 0});
    for (JointDef& joint : def.joints) joint.initial_rotation = direction(5);
    def.shapes = {box_shape("Sides", "Box", {0.3, 0.4, 0.5}), ball_shape("Skin", "Ball", 0.15)};
    def.frictions = {dry_friction("Dry", 0.4)};
    def.contacts = {pair_of("Sides", "Skin", {.stiffness = 1e5, .restitution = uniform(0.1, 1)}, "Dry")};
    return def;
  }

  // a box that turns as it falls
  MechanicsDef fall() {
    MechanicsDef def;
    def.gravity = {0, -9.81, 0};
    add_free(def, box_body("Box", 2, {0.3, 0.2, 0.4}, {0, 0.6, 0}), direction(1));
    def.joints[0].initial_rotation = direction(6);
    def.shapes = {box_shape("Sides", "Box", {0.3, 0.2, 0.4}), ground_shape("Floor")};
    def.frictions = {dry_friction("Dry", 0.4)};
    def.contacts = {pair_of("Sides", "Floor",
                            {.stiffness = 1e5, .restitution = uniform(0.1, 0.6), .smallest_impact_speed = 0.1}, "Dry")};
    return def;
  }

  std::mt19937_64 random_{11};
};

TEST_F(FreeContact, KeepsLinearAndAngularMomentum) {
  for (int i = 0; i < rounds(10, 200); ++i) {
    const MechanicsDef def = pair();
    for (const Formulation formulation : {Formulation::recursive, Formulation::lagrange}) {
      Motion motion(def, formulation);
      const Momentum before = momentum(motion.model, motion.ws);
      bool has_touched = false;
      for (int n = 0; n < 1000; ++n) {
        motion.step(1e-3);
        has_touched = has_touched || !motion.state.contacts.states().empty();
      }
      motion.see();
      const Momentum after = momentum(motion.model, motion.ws);
      EXPECT_TRUE(has_touched);
      for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR(after.linear[k], before.linear[k], 1e-10 * 20);  // 20 N s is the largest of a body
        EXPECT_NEAR(after.angular[k], before.angular[k], 1e-6);
      }
    }
  }
}

TEST_F(FreeContact, TakesEnergyAway) {
  for (int i = 0; i < rounds(10, 200); ++i) {
    Motion motion(fall());
    const double start = motion.total_energy();
    double least = start, rise = 0;
    for (int n = 0; n < 1500; ++n) {
      motion.step(1e-3);
      motion.see();
      const double now = motion.total_energy();
      rise = std::max(rise, now - least);
      least = std::min(least, now);
    }
    // shares of points of unequal depth are no potential: a rocking box regains a little energy
    EXPECT_LT(rise, 1e-2 * start);
    EXPECT_LT(least, 0.6 * start);
    EXPECT_GT(motion.pose("Box").position[1], 0.1 - 1e-3);
  }
}

TEST_F(FreeContact, IsTheSameInBothFormulations) {
  for (int i = 0; i < rounds(10, 100); ++i) {
    const MechanicsDef def = pair();
    Motion joint(def, Formulation::recursive), body(def, Formulation::lagrange);
    joint.run(0.6, 1e-3);
    body.run(0.6, 1e-3);
    for (const char* name : {"Box", "Ball"}) {
      const BodyPose a = joint.pose(name), b = body.pose(name);
      for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR(a.position[k], b.position[k], 1e-8);
        EXPECT_NEAR(a.velocity[k], b.velocity[k], 1e-7);
        EXPECT_NEAR(a.angular_velocity[k], b.angular_velocity[k], 1e-6);
      }
    }
  }
}

}  // namespace contact_test
}  // namespace slew::multibody
