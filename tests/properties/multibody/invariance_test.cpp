// SPDX-License-Identifier: Apache-2.0
// Random trees and loops move alike wherever they stand, however they are turned, and in whichever units they are
// written, in every formulation.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/properties/multibody/def_transforms.h"
#include "tests/properties/multibody/random_motion.h"
#include "tests/support/nightly.h"
#include "tests/validation/multibody/every_formulation.h"

namespace slew::multibody {
namespace invariance_test {

using namespace testing;
using math::Mat3;
using math::Vec3;

constexpr int kSteps = 20;
constexpr double kStep = 1e-3;

// two seeds of three have loops, whose joints are of every type in twelve of them
constexpr std::uint32_t kGateSeeds = 24;
const std::vector<std::uint32_t> kSeeds = slew::testing::seeds({{1, 300}}, kGateSeeds);

std::vector<std::uint32_t> every_third(const std::vector<std::uint32_t>& seeds) {
  std::vector<std::uint32_t> third;
  for (std::size_t i = 0; i < seeds.size(); i += 3) third.push_back(seeds[i]);
  return third;
}

class Invariance : public EveryFormulation {
 protected:
  // Penalties of 1e7 masses amplify the rounding of the compared values.
  static double tolerance() { return is(Formulation::penalty) || is(Formulation::augmented) ? 1e-6 : 1e-8; }
};

// steps of a state; false: nothing moves
bool run_from(Formulated& mechanism, const MechanicsDef& def, const State& state, double step) {
  if (mechanism.model.degrees_of_freedom() == 0) return false;
  copy_state(state, mechanism.state);
  restart(mechanism, def);
  EXPECT_TRUE(mechanism.try_run(kSteps * step, step));
  return true;
}

TEST_P(Invariance, TurnedAndMovedMechanismsMoveAlike) {
  const Mat3 R = math::rotation_xyz({0.7, -0.4, 2.1});
  const Vec3 p(3, -5, 2);
  slew::testing::for_each_seed(kSeeds, [&](std::uint32_t seed) {
    MechanicsDef def = random_mechanism(seed);
    def.formulation = GetParam();
    const MechanicsDef other_def = turned_and_moved(def, R, p);
    Formulated plain(def), other(other_def);
    set_random_speeds(plain, seed, 0.5);
    const State start = plain.state;
    if (!run_from(plain, def, start, kStep)) return;
    ASSERT_TRUE(run_from(other, other_def, turned_and_moved(plain.model, start, R, p), kStep));
    double error = 0, scale = 1;
    for (const BodyDef& body : def.bodies) {
      const BodyPose a = plain.pose(body.name), b = other.pose(body.name);
      const Vec3 v(a.velocity), w(a.angular_velocity);
      scale = std::max({scale, norm(v), norm(w)});
      error = std::max({error, norm(R * Vec3(a.center_of_mass) + p - Vec3(b.center_of_mass)),
                        norm(R * v - Vec3(b.velocity)), norm(R * w - Vec3(b.angular_velocity))});
    }
    EXPECT_LT(error, tolerance() * scale) << "seed " << seed;
    EXPECT_NEAR(energy(plain.model, plain.ws).kinetic, energy(other.model, other.ws).kinetic,
                tolerance() * scale * scale * 100)
        << "seed " << seed;
  });
}

TEST_P(Invariance, OtherUnitsGiveTheSameMotion) {
  for (const Units& units : {Units{1000, 1, 1}, Units{1, 1e-3, 1}, Units{1, 1, 60}, Units{3.28, 2.2, 0.1}}) {
    slew::testing::for_each_seed(every_third(kSeeds), [&](std::uint32_t seed) {
      MechanicsDef def = random_mechanism(seed);
      def.formulation = GetParam();
      const MechanicsDef other_def = in_units(def, units);
      Formulated plain(def), other(other_def);
      set_random_speeds(plain, seed, 0.5);
      const State start = plain.state;
      if (!run_from(plain, def, start, kStep)) return;
      ASSERT_TRUE(run_from(other, other_def, in_units(plain.model, start, units), kStep * units.time));
      double error = 0, scale = 1;
      for (const BodyDef& body : def.bodies) {
        const BodyPose a = plain.pose(body.name), b = other.pose(body.name);
        const double L = units.length, T = units.time;
        const Vec3 v(a.velocity), w(a.angular_velocity);
        scale = std::max({scale, norm(v), norm(w)});
        error = std::max({error, norm(Vec3(a.center_of_mass) - Vec3(b.center_of_mass) * (1 / L)),
                          norm(v - Vec3(b.velocity) * (T / L)), norm(w - Vec3(b.angular_velocity) * T)});
      }
      EXPECT_LT(error, tolerance() * scale)
          << "seed " << seed << ", units " << units.length << " " << units.mass << " " << units.time;
    });
  }
}

INSTANTIATE_TEST_SUITE_P(In, Invariance, kEveryFormulation, kFormulationName);

}  // namespace invariance_test
}  // namespace slew::multibody
