// SPDX-License-Identifier: Apache-2.0
// The hash of a subsystem's state covers every bit that its future depends on.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>
#include <set>
#include <span>
#include <vector>

#include "support/crane_pair.h"
#include "support/mechanics_alone.h"

namespace slew::testing {
namespace subsystem_hash_test {

double next(double value) {
  return std::nextafter(value, 1e300);
}

class SubsystemHash : public ::testing::Test {
 protected:
  void SetUp() override {
    crane.start();
    for (int i = 0; i < 400; ++i) crane.step(CranePair::levers(crane.n));
  }
  // every number, one after the other, one unit in the last place up and back
  void expect_each_counts(coupling::Subsystem& subsystem, std::span<double> values, const char* what) {
    const std::uint64_t before = subsystem.state_hash();
    std::set<std::uint64_t> seen = {before};
    for (std::size_t i = 0; i < values.size(); ++i) {
      const double value = values[i];
      values[i] = next(value);
      EXPECT_TRUE(seen.insert(subsystem.state_hash()).second) << what << "[" << i << "] is not in the hash";
      values[i] = value;
    }
    EXPECT_EQ(subsystem.state_hash(), before);
  }

  const scene::Scene scene = CranePair::load();
  CranePair crane{scene};
};

TEST_F(SubsystemHash, OfMechanicsChangesWithEveryCoordinateAndSpeedByOneUlp) {
  multibody::State& state = crane.mechanics->mutable_state();
  ASSERT_GE(state.q.size(), 7u);
  expect_each_counts(*crane.mechanics, state.q, "q");
  expect_each_counts(*crane.mechanics, state.u, "u");
}

TEST_F(SubsystemHash, OfHydraulicsChangesWithEveryStateAndTheStepSizeByOneUlp) {
  hydraulics::CircuitIntegrator& integrator = crane.hydraulics->integrator();
  expect_each_counts(*crane.hydraulics, integrator.mutable_state(), "y");
  const std::uint64_t before = crane.hydraulics->state_hash();
  integrator.set_step_size(next(integrator.step_size()));
  EXPECT_NE(crane.hydraulics->state_hash(), before);
}

TEST_F(SubsystemHash, OfMechanicsHoldsItsOwnCopyOfThePortForces) {
  // two mechanics that differ in one ulp of one cylinder's force at the start, and in nothing else
  for (std::size_t port = 0; port < crane.hydraulics_now.actuators.F.size(); ++port) {
    std::uint64_t hashes[2] = {};
    for (int changed = 0; changed < 2; ++changed) {
      CranePair fresh(scene);
      fresh.start();
      coupling::ActuatorSample start = fresh.hydraulics_now.actuators;
      if (changed == 1) start.F[port] = next(start.F[port]);
      ASSERT_TRUE(fresh.mechanics->start({nullptr, &start}, fresh.mechanics_now).is_ok());
      hashes[changed] = fresh.mechanics->state_hash();
    }
    EXPECT_NE(hashes[0], hashes[1]) << port;
  }
}

TEST_F(SubsystemHash, ChangesWithAParameterChangeUnderWay) {
  for (const auto& [subsystem, path, value] :
       {std::tuple<coupling::Subsystem*, const char*, double>{crane.mechanics.get(), "Bag.mass", 1500},
        std::tuple<coupling::Subsystem*, const char*, double>{crane.hydraulics.get(), "MainPump.set_pressure", 2e6}}) {
    const std::uint64_t before = subsystem->state_hash();
    ASSERT_TRUE(subsystem->change_parameter(crane.n, {path, value, milliseconds(100)}));
    const std::uint64_t under_way = subsystem->state_hash();
    EXPECT_NE(under_way, before) << path;
    // another target, another duration, another beginning: each is another state
    ASSERT_TRUE(subsystem->change_parameter(crane.n, {path, next(value), milliseconds(100)}));
    const std::uint64_t other_target = subsystem->state_hash();
    ASSERT_TRUE(subsystem->change_parameter(crane.n, {path, value, milliseconds(101)}));
    const std::uint64_t other_duration = subsystem->state_hash();
    ASSERT_TRUE(subsystem->change_parameter(crane.n + 1, {path, value, milliseconds(100)}));
    const std::uint64_t other_step = subsystem->state_hash();
    EXPECT_EQ((std::set<std::uint64_t>{under_way, other_target, other_duration, other_step}.size()), 4u) << path;
  }
}

TEST_F(SubsystemHash, ChangesWithTheLevelOfAPort) {
  for (coupling::Subsystem* subsystem : {static_cast<coupling::Subsystem*>(crane.mechanics.get()),
                                         static_cast<coupling::Subsystem*>(crane.hydraulics.get())}) {
    std::set<std::uint64_t> seen = {subsystem->state_hash()};
    for (const char* path : {"session.coupling", "Cyl_Lift.coupling", "Cyl_Jib.coupling"}) {
      ASSERT_TRUE(subsystem->change_parameter(crane.n, {path, 1, {}}));
      EXPECT_TRUE(seen.insert(subsystem->state_hash()).second) << path;
    }
  }
}

TEST_F(SubsystemHash, OfHydraulicsChangesWithEveryStateOfALineByOneUlp) {
  ASSERT_TRUE(crane.mechanics->change_parameter(crane.n, {"Cyl_Lift.coupling", 4, {}}));
  ASSERT_TRUE(crane.hydraulics->change_parameter(crane.n, {"Cyl_Lift.coupling", 4, {}}));
  for (int i = 0; i < 50; ++i) crane.step(CranePair::levers(crane.n));
  int lines = 0;
  for (hydraulics::LineChamber& line : crane.hydraulics->integrator().mutable_lines()) {
    if (!line.is_line) continue;
    ++lines;
    hydraulics::LineState& state = line.state;
    std::array values = {&state.c_h, &state.c_m, &state.c_m_next, &state.Z, &state.Z_next, &state.x};
    for (double* value : values) expect_each_counts(*crane.hydraulics, {value, 1}, "line");
  }
  EXPECT_EQ(lines, 2);
}

TEST_F(SubsystemHash, ChangesWithTheValueOfAParameterThatHasArrived) {
  CranePair other(scene);
  other.start();
  for (int i = 0; i < 400; ++i) other.step(CranePair::levers(other.n));
  ASSERT_EQ(other.mechanics->state_hash(), crane.mechanics->state_hash());
  ASSERT_TRUE(other.mechanics->change_parameter(other.n, {"Bag.mass", next(500), {}}));
  ASSERT_TRUE(other.hydraulics->change_parameter(other.n, {"MainPump.set_pressure", next(2.5e6), {}}));
  other.step(CranePair::levers(other.n));
  crane.step(CranePair::levers(crane.n));
  EXPECT_NE(other.mechanics->state_hash(), crane.mechanics->state_hash());
  EXPECT_NE(other.hydraulics->state_hash(), crane.hydraulics->state_hash());
}

TEST(SubsystemHashOfAPendulum, DependsOnWhetherAJointLimitTakesPart) {
  const scene::Scene scene = scene::load_text(R"(
bodies:
  Rod: {position: [0, 2 m, 0], mass: 2 kg, center_of_mass: [0.5 m, 0, 0], inertia: [0, 0.167, 0.167]}
joints:
  Hinge: {type: revolute, body1: Ground, point1: [0, 2 m, 0], body2: Rod, limit_min: -1, limit_max: 1,
          limit_stiffness: 1e4 Nm/rad}
)",
                                              "pendulum");
  mechanics_node::MechanicsSubsystem pendulum(scene);
  coupling::OwnSample sample;
  static_cast<void>(pendulum.first_sample(sample));
  ASSERT_TRUE(pendulum.start({}, sample).is_ok());
  const multibody::State start = pendulum.state();
  const std::uint64_t taking_part = pendulum.state_hash();
  // far from its limits the first step leaves them out; with the coordinates put back nothing else is different
  pendulum.step(0, {}, {}, sample);
  pendulum.mutable_state() = start;
  EXPECT_NE(pendulum.state_hash(), taking_part);
}

// The copy of the mechanics' model serves until the next exchange. At level hold no piston uses it, so that the circuit
// is the same with another copy; a level that changes live before the next exchange uses it.
TEST_F(SubsystemHash, OfHydraulicsHoldsTheModelOfTheMechanicsBetweenExchanges) {
  const scene::Scene every_fourth = CranePair::load({"session.exchange_every=4", "session.coupling=hold"});
  for (std::size_t port = 0; port < crane.mechanics_now.mechanism.a_free.size(); ++port) {
    std::uint64_t hashes[2] = {};
    std::vector<double> states[2];
    for (int changed = 0; changed < 2; ++changed) {
      CranePair pair(every_fourth);
      pair.start();
      double& a_free = pair.mechanics_now.mechanism.a_free[port];
      if (changed == 1) a_free = next(a_free);
      pair.step(CranePair::levers(pair.n));
      hashes[changed] = pair.hydraulics->state_hash();
      const std::span<const double> y = pair.hydraulics->integrator().mutable_state();
      states[changed].assign(y.begin(), y.end());
    }
    EXPECT_EQ(states[0], states[1]) << port;
    EXPECT_NE(hashes[0], hashes[1]) << port;
  }
}

// Between fixed pressures no state of the circuit depends on the signal; the change that the next step expects does.
TEST(SubsystemHashOfASource, DependsOnTheLastChangeOfItsSignal) {
  const scene::Scene scene = scene::load_text(R"(
hydraulics: {start_return_pressure: 1 bar}
volumes: {T: {initial_pressure: 1 bar, fixed: true}, V: {initial_pressure: 1 bar, fixed: true}}
components: {F: {type: flow_source, port_1: T, port_2: V, flow_per_signal: 1 l/min}}
inputs: {I: {type: analog, primitive: F}}
session: {step: 1 ms, duration: 1 s}
)",
                                              "source");
  std::uint64_t hashes[2] = {};
  for (int stepped = 0; stepped < 2; ++stepped) {
    hydraulics_node::HydraulicsSubsystem source(scene);
    coupling::OwnSample sample;
    ASSERT_TRUE(source.start({}, sample).is_ok());
    for (int n = 0; n < 4; ++n) {
      const double signal[] = {stepped == 1 && n < 3 ? 0.5 : 1.0};
      source.step(n, {}, signal, sample);
    }
    hashes[stepped] = source.state_hash();
  }
  EXPECT_NE(hashes[0], hashes[1]);
}

// A wheel that turns by 4 rad in a step: no step converges, and the excess of such steps ends the run. `steps` of them,
// then the coordinates of the start: wheels of other `steps` differ in nothing but their count.
std::unique_ptr<MechanicsAlone> fast_wheel(int steps) {
  auto wheel = std::make_unique<MechanicsAlone>(
      scene::load_text("mechanics: {formulation: recursive, max_substep: 1 ms}\n"
                       "bodies: {Wheel: {mass: 1 kg, inertia: [1, 1, 1]}}\n"
                       "joints: {Pin: {type: revolute, body2: Wheel, initial_velocity: 4000 rad/s}}\n"
                       "session: {step: 1 ms, duration: 1 s}\n",
                       "wheel"));
  const multibody::State start = wheel->subsystem.state();
  for (int i = 0; i < steps; ++i) {
    wheel->step();
    EXPECT_TRUE(wheel->report.has(StepFlag::not_converged)) << i;
  }
  wheel->subsystem.mutable_state() = start;
  return wheel;
}

TEST(SubsystemHashOfAFastWheel, CountsTheStepsThatDidNotConverge) {
  for (const int steps : {1, 10, mechanics_node::kMostUnconverged - 2}) {
    const auto wheel = fast_wheel(steps), same = fast_wheel(steps), later = fast_wheel(steps + 1);
    EXPECT_EQ(wheel->subsystem.state_hash(), same->subsystem.state_hash()) << steps;
    EXPECT_NE(wheel->subsystem.state_hash(), later->subsystem.state_hash()) << steps;
    // one step that the later one has less
    while (!later->report.has_failed()) wheel->step(), later->step();
    EXPECT_EQ(later->n, mechanics_node::kMostUnconverged);
    EXPECT_FALSE(wheel->report.has_failed()) << steps;
    wheel->step();
    EXPECT_TRUE(wheel->report.has(StepFlag::ended)) << steps;
  }
}

// The coupling's alarm alone ends it: the works that the mechanics state enter no pressure.
TEST_F(SubsystemHash, OfHydraulicsHoldsThatTheAlarmHasEndedIt) {
  CranePair ended(scene);
  ended.start();
  while (ended.n < crane.n) ended.step(CranePair::levers(ended.n));
  while (ended.hydraulics->failure_text().empty()) {
    ASSERT_EQ(ended.hydraulics->state_hash(), crane.hydraulics->state_hash()) << ended.n;
    ASSERT_LT(ended.n, 1500);
    for (double& work : ended.mechanics_now.mechanism.work) work += 1e4;
    ended.step(CranePair::levers(ended.n));
    crane.step(CranePair::levers(crane.n));
  }
  const std::span<const double> y = ended.hydraulics->integrator().state(),
                                good = crane.hydraulics->integrator().state();
  EXPECT_EQ(std::vector<double>(y.begin(), y.end()), std::vector<double>(good.begin(), good.end()));
  EXPECT_NE(ended.hydraulics->state_hash(), crane.hydraulics->state_hash());
}

// The torque of the signal that acts is shown, and so is part of the state; coordinates and speeds are put back.
TEST(SubsystemHashOfADrum, DependsOnTheSignalThatActs) {
  std::uint64_t hashes[2] = {};
  double torques[2] = {};
  for (int full = 0; full < 2; ++full) {
    MechanicsAlone drum("scenes/forces/operated.yaml");
    const multibody::State start = drum.subsystem.state();
    const double signal[] = {full == 1 ? 1.0 : 0.5};
    drum.subsystem.step(0, {}, signal, drum.sample);
    drum.subsystem.mutable_state() = start;
    hashes[full] = drum.subsystem.state_hash();
    torques[full] = drum.value("Motor.torque");
  }
  EXPECT_EQ(torques[0], 10);
  EXPECT_EQ(torques[1], 20);
  EXPECT_NE(hashes[0], hashes[1]);
}

TEST_F(SubsystemHash, DistinguishesAFailedStateFromAGoodOne) {
  const std::uint64_t before = crane.mechanics->state_hash();
  crane.mechanics->mutable_state().u[0] = std::numeric_limits<double>::infinity();
  crane.step(CranePair::levers(crane.n));
  EXPECT_NE(crane.mechanics->state_hash(), before);
}

TEST_F(SubsystemHash, AfterAResetIsThatOfAFreshOneAtEveryStep) {
  ASSERT_TRUE(crane.mechanics->change_parameter(crane.n, {"Bag.mass", 1500, milliseconds(100)}));
  ASSERT_TRUE(crane.hydraulics->change_parameter(crane.n, {"MainPump.set_pressure", 2e6, {}}));
  for (const char* path : {"session.coupling", "Cyl_Jib.coupling"}) {
    ASSERT_TRUE(crane.mechanics->change_parameter(crane.n, {path, 3, {}}));
    ASSERT_TRUE(crane.hydraulics->change_parameter(crane.n, {path, 3, {}}));
  }
  for (int i = 0; i < 50; ++i) crane.step(CranePair::levers(crane.n));
  crane.mechanics->reset();
  crane.hydraulics->reset();
  crane.start();
  CranePair fresh(scene);
  fresh.start();
  for (int i = 0; i < 600; ++i) {
    ASSERT_EQ(crane.mechanics->state_hash(), fresh.mechanics->state_hash()) << i;
    ASSERT_EQ(crane.hydraulics->state_hash(), fresh.hydraulics->state_hash()) << i;
    crane.step(CranePair::levers(crane.n));
    fresh.step(CranePair::levers(fresh.n));
  }
}

}  // namespace subsystem_hash_test
}  // namespace slew::testing
