// SPDX-License-Identifier: Apache-2.0
// Case P01: the same mechanisms in Simbody 3.7, built from the same definitions through its own interface
// (simbody_peer.h): the crane of scenes/truck_crane.yaml at 12 random states, seeds 1 to 12, and 48 random trees of 2
// to 10 bodies, seeds 1 to 48 (revolute, prismatic, spherical, floating and fixed joints in both directions, springs,
// dampers, dummies), with random forces on cylinders, drives and joints.
//
// An instant: accelerations of all bodies, reactions of all joints, kinetic energy, and the values for a partner of the
// coupling (x, v, a_free, W). Both recursions are exact; the difference is rounding, which loops of light cylinders on
// heavy booms enlarge: 4e-14 at most, 1e-12 allowed.
//
// A motion: the crane falls for 2 s from the scene's start without actuators, limits and joint friction; the trees of
// seeds 1 to 16 move for 0.5 s under gravity alone, since the kinks of end springs cost either integrator its order.
// Simbody integrates by Runge-Kutta-Merson with local errors of 1e-12.
//   sub-step 0.1 ms: 1e-10 rad and m, energies 1e-10 of the peak kinetic energy; four times what is reached, which is
//   Simbody's own error: ours would be 1e-13
//   sub-step 1 ms, the scene's: 1e-8 likewise, eight times what is reached; the error of ours, order 4
//
// With loops, where cut joints are Simbody's own constraints (simbody_mechanism.h) and multipliers are found by its
// orthogonal factorisation: the crane with both cylinders as two bodies each, 48 random mechanisms that have every
// joint type among the cut ones, the scenes of the four-bars, the slider-crank and the thirteen joints. 1e-9 allowed;
// reached 6e-13 for accelerations, 6e-14 for the reactions of joints and constraints. Redundant rows leave reactions
// open: then either's differ by what loads no body, and the sum of squares of ours is not larger. The slider-crank
// moves for 1 s in sub-steps of 0.1 ms: 1e-8, ten times what is reached with either's projections.
#include <algorithm>

#include "tests/peers/multibody/agreement.h"
#include "tests/peers/multibody/simbody_peer.h"

namespace slew::multibody::testing {
namespace simbody_test {

constexpr double kTolerance = 1e-12, kLoopTolerance = 1e-9;

class Mechanisms : public ::testing::TestWithParam<Case> {
 protected:
  void SetUp() override {
    const Mechanism mechanism(sample.def);
    const std::vector<Cut>& cuts = mechanism.model.cuts;
    const auto holds_nothing = [](const Cut& cut) { return cut.rows.empty(); };
    if (!cuts.empty() && std::all_of(cuts.begin(), cuts.end(), holds_nothing)) {
      GTEST_SKIP() << "Simbody's answer is not finite where the constraints forbid nothing that the tree allows";
    }
  }

  const Sample sample{GetParam(), ForceDummies::with};
  const double tolerance = has_loops(GetParam()) ? kLoopTolerance : kTolerance;
};

TEST_P(Mechanisms, AccelerateLikeSimbody) {
  if (Mechanism(sample.def).model.degrees_of_freedom() == 0) GTEST_SKIP() << "nothing moves";
  const double difference = accelerations_differ_by<SimbodyPeer>(sample, sample.def);
  record("difference", difference);
  EXPECT_LT(difference, tolerance);
}

TEST_P(Mechanisms, ShowTheRowsThatSimbodySees) {
  if (sample.rows.empty()) GTEST_SKIP() << "nothing to act on";
  expect_same_rows(rows_differ_by<SimbodyPeer>(sample), tolerance);
}

TEST_P(Mechanisms, LoadTheirJointsLikeSimbody) {
  MechanicsDef def = sample.def;
  // no motion determines the axis of a rotational spring between two welded bodies
  for (RotationalForceDef& force : def.rotational_forces) force.spring_constant = 0;
  Mechanism ours(def);
  std::vector<JointReaction> expected(def.joints.size());
  joint_reactions(ours.model, sample.state, ours.ws, {}, expected);
  SimbodyPeer peer(def);
  peer.set_motion(motions_of(ours.model, ours.ws));
  static_cast<void>(peer.accelerate(Wrenches(def.bodies.size() + 1)));
  const std::vector<JointReaction> got = peer.reactions();
  // redundant rows leave the reactions open: they load the bodies alike, and ours are the smallest
  const bool are_open = has_redundant_rows(ours.model);
  const double difference = are_open ? load_difference(def, motions_of(ours.model, ours.ws), got, expected)
                                     : reaction_difference(got, expected);
  record("difference", difference);
  EXPECT_LT(difference, tolerance);
  EXPECT_LE(square_of(expected), square_of(got) * (1 + tolerance) + tolerance);
}

TEST_P(Mechanisms, HaveTheKineticEnergyThatSimbodySees) {
  Mechanism ours(sample.def);
  ours.state = sample.state;
  ours.see();
  const double expected = energy(ours.model, ours.ws).kinetic;
  SimbodyPeer peer(sample.def);
  peer.set_motion(motions_of(ours.model, ours.ws));
  const double difference = std::abs(peer.energy().kinetic - expected) / expected;
  record("difference", difference);
  EXPECT_LT(difference, tolerance);
}

INSTANTIATE_TEST_SUITE_P(OfOurs, Mechanisms, ::testing::ValuesIn(cases()), case_name);
INSTANTIATE_TEST_SUITE_P(WithLoops, Mechanisms, ::testing::ValuesIn(loop_cases()), case_name);

TEST(ComparisonWithSimbody, SeesAMassThatIsAMillionthOff) {
  const Sample sample({Case::Kind::truck_crane, 1}, ForceDummies::with);
  for (std::size_t i = 0; i < sample.def.force_dummies.size(); ++i) {
    MechanicsDef other = sample.def;
    other.force_dummies[i].mass *= 1 + 1e-6;
    EXPECT_GT(accelerations_differ_by<SimbodyPeer>(sample, other), kTolerance) << other.force_dummies[i].name;
  }
  MechanicsDef other = sample.def;
  other.bodies.back().mass *= 1 + 1e-6;
  EXPECT_GT(accelerations_differ_by<SimbodyPeer>(sample, other), 1e4 * kTolerance);
}

struct MotionDifference {
  double pose = 0;    // rad and m
  double energy = 0;  // error of the change of either kind of energy, relative to the peak kinetic energy
};

// Ours in steps of h beside Simbody's for a time of 20 looks.
MotionDifference motions_differ_by(const MechanicsDef& def, const State& start, double time, double h) {
  constexpr double kAccuracy = 1e-12;
  constexpr int kLooks = 20;
  Mechanism ours(def);
  ours.state = start;
  ours.see();
  SimbodyPeer peer(def);
  peer.set_motion(motions_of(ours.model, ours.ws));
  const Energy our_start = energy(ours.model, ours.ws), peer_start = peer.energy();
  MotionDifference largest;
  double peak = 0;
  for (int i = 0; i < kLooks; ++i) {
    ours.run(time / kLooks, h);
    peer.run(time / kLooks, kAccuracy);
    const Motions moved = peer.accelerate(Wrenches(def.bodies.size() + 1));
    grow(largest.pose, pose_difference(motions_of(ours.model, ours.ws), moved));
    const Energy here = energy(ours.model, ours.ws), there = peer.energy();
    const double potential = (here.potential - our_start.potential) - (there.potential - peer_start.potential);
    grow(largest.energy, std::abs(here.kinetic - there.kinetic));
    grow(largest.energy, std::abs(potential));
    grow(peak, there.kinetic);
  }
  largest.energy /= peak;
  return largest;
}

void expect_small(const MotionDifference& difference, const MotionDifference& allowed) {
  record("pose", difference.pose);
  record("energy", difference.energy);
  EXPECT_LT(difference.pose, allowed.pose);
  EXPECT_LT(difference.energy, allowed.energy);
}

constexpr MotionDifference kFine = {.pose = 1e-10, .energy = 1e-10}, kCoarse = {.pose = 1e-8, .energy = 1e-8};

class RandomTrees : public ::testing::TestWithParam<unsigned> {};

TEST_P(RandomTrees, MoveAsInSimbody) {
  const Sample sample({Case::Kind::random_tree, GetParam()}, ForceDummies::with);
  MechanicsDef def = bare(sample.def);
  def.gravity = sample.def.gravity;
  expect_small(motions_differ_by(def, sample.state, 0.5, 1e-4), kFine);
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomTrees, ::testing::Range(1u, 17u));

TEST(SliderCrank, MovesAsInSimbody) {
  const Sample sample({.kind = Case::Kind::scene, .seed = 1, .scene = "slider_crank"}, ForceDummies::with);
  expect_small(motions_differ_by(sample.def, Mechanism(sample.def).state, 1, 1e-4), kCoarse);
}

class TruckCrane : public ::testing::Test {
 protected:
  std::vector<std::string> rows;
  const MechanicsDef def = truck_crane(rows);
  const State start = Mechanism(def).state;
};

TEST_F(TruckCrane, FallsAsInSimbody) {
  expect_small(motions_differ_by(undamped(def), start, 2, 1e-4), kFine);
}

TEST_F(TruckCrane, FallsAsInSimbodyWithItsDampers) {
  expect_small(motions_differ_by(def, start, 2, 1e-4), kFine);
}

TEST_F(TruckCrane, FallsAsInSimbodyAtTheSubStepOfTheScene) {
  expect_small(motions_differ_by(undamped(def), start, 2, def.max_substep), kCoarse);
}

}  // namespace simbody_test
}  // namespace slew::multibody::testing
