// SPDX-License-Identifier: Apache-2.0
#include "io_node/input_gate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <initializer_list>
#include <limits>
#include <random>
#include <vector>

#include "tests/support/nightly.h"

namespace slew::io_node {
namespace input_gate_test {

using testing::rounds;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr std::int64_t kMs = 1'000'000;

// A script that holds these values over the step.
std::vector<SignalCourse> held(std::initializer_list<double> raw) {
  std::vector<SignalCourse> courses;
  for (const double value : raw) courses.push_back({{1, value, value}});
  return courses;
}

ChannelConfig channel(const char* name, double scale, double ramp) {
  ChannelConfig config;
  config.name = name;
  config.scale = scale;
  config.dead_zone = 0.2;
  config.ramp = ramp;
  return config;
}

InputGate crane_gate(double ramp = 0) {
  return InputGate({channel("Input_Slew", -500, ramp), channel("Input_Lift", 500, ramp)}, GateConfig{},
                   milliseconds(1));
}

TEST(InputGate, DeadZoneCutsAndScaleHasItsSign) {
  InputGate gate = crane_gate();
  gate.advance(0, held({0.19, 0.21}), 0);
  EXPECT_EQ(gate.control(0), 0.0);
  EXPECT_NEAR(gate.control(1), 105, 1e-12);  // not rescaled
  gate.advance(1, held({1.0, -1.0}), 0);
  EXPECT_EQ(gate.control(0), -500);
  EXPECT_EQ(gate.control(1), -500);
}

// Two courses of the same mean, at 1.5 of the ramp's 2 per step at most: the next step begins where each has ended.
TEST(InputGate, TheEndOfARampIsPartOfTheHash) {
  const auto after = [](const SignalCourse& course) {
    InputGate gate = crane_gate(0.5e-3);
    for (StepIndex n = 0; n < 3; ++n) gate.advance(n, held({0.5, 0.5}), 0);
    gate.advance(3, std::vector<SignalCourse>{course, course}, 0);
    return gate;
  };
  const InputGate level = after({{1, 0.5, 0.5}}), swung = after({{0.5, 0.5, 0.25}, {0.5, 0.25, 1.0}});
  for (std::size_t i = 0; i < 2; ++i) {
    ASSERT_EQ(level.raw(i), swung.raw(i));
    ASSERT_EQ(level.control(i), swung.control(i));
  }
  StateHash of_level, of_swung;
  level.add_to(of_level);
  swung.add_to(of_swung);
  EXPECT_NE(of_level.digest(), of_swung.digest());
}

TEST(InputGate, RampTakesItsTimeForAFullStroke) {
  InputGate gate = crane_gate(0.5);
  for (StepIndex n = 0; n < 250; ++n) gate.advance(n, held({0, 1}), 0);
  // the mean over the step that ends half way
  EXPECT_NEAR(gate.control(1), 249.5, 1e-9);
  for (StepIndex n = 250; n < 500; ++n) gate.advance(n, held({0, 1}), 0);
  EXPECT_NEAR(gate.control(1), 499.5, 1e-9);
  gate.advance(500, held({0, 1}), 0);
  EXPECT_NEAR(gate.control(1), 500, 1e-9);
}

TEST(InputGate, RateLimitHoldsWhereTheRampIsFaster) {
  ChannelConfig channel;
  channel.name = "Input_Lift";
  channel.scale = 500;
  channel.ramp = 0.1;
  channel.rate_limit = 2;
  InputGate gate({channel}, GateConfig{}, milliseconds(1));
  for (StepIndex n = 0; n < 250; ++n) gate.advance(n, held({1}), 0);
  EXPECT_NEAR(gate.control(0), 249.5, 1e-9);
}

TEST(InputGate, TheScriptsSignalGivesItsMeanOverTheStepAndAControllersValueIsHeld) {
  ChannelConfig button = channel("Button", 1, 0);
  button.is_digital = true;
  InputGate gate({channel("Input_Slew", -500, 0), channel("Input_Lift", 500, 0), button}, GateConfig{},
                 milliseconds(1));
  const std::vector<SignalCourse> script = {
      {{0.25, 0.4, 0.8}, {0.75, -1, -0.6}}, {{1, 0.3, 0.5}}, {{0.5, 1, 1}, {0.5, 0, 0}}};
  gate.advance(0, script, 0);
  EXPECT_DOUBLE_EQ(gate.raw(0), -0.45);
  EXPECT_DOUBLE_EQ(gate.control(0), 225);
  EXPECT_DOUBLE_EQ(gate.raw(1), 0.4);
  EXPECT_DOUBLE_EQ(gate.control(1), 200);
  EXPECT_EQ(gate.control(2), 1) << "a button is pressed or not, as at the begin of the step";
  ASSERT_TRUE(gate.acquire(1, "pid", 0).is_granted);
  EXPECT_TRUE(gate.write(1, "pid", 0.9, 0, 0));
  gate.advance(1, script, 0);
  EXPECT_EQ(gate.raw(1), 0.9);
  EXPECT_EQ(gate.control(1), 450);
  // nothing from the script: neutral
  gate.advance(2, std::vector<SignalCourse>{{}}, 0);
  EXPECT_EQ(gate.control(0), 0);
  EXPECT_EQ(gate.control(2), 0);
  EXPECT_EQ(gate.rejected_not_finite(), 0u);
}

TEST(InputGate, NanAndOutOfRangeAreCountedAndNeverPassOn) {
  InputGate gate = crane_gate();
  ASSERT_TRUE(gate.acquire(1, "pid", 0).is_granted);
  EXPECT_TRUE(gate.write(1, "pid", 0.5, 0, 0));
  EXPECT_FALSE(gate.write(1, "pid", kNan, 1, 0));
  EXPECT_FALSE(gate.write(1, "pid", std::numeric_limits<double>::infinity(), 1, 0));
  EXPECT_EQ(gate.rejected_not_finite(), 2u);
  gate.advance(1, held({0, 0}), 0);
  EXPECT_NEAR(gate.control(1), 250, 1e-12);  // the last good value
  EXPECT_TRUE(gate.write(1, "pid", 7, 2, 0));
  gate.advance(2, held({kNan, 0}), 0);
  EXPECT_EQ(gate.control(1), 500);
  EXPECT_EQ(gate.control(0), 0);
  EXPECT_EQ(gate.clamped(), 1u);
  EXPECT_EQ(gate.rejected_not_finite(), 3u);
}

TEST(InputGate, LeaseIsRefusedWithTheHoldersName) {
  InputGate gate = crane_gate();
  EXPECT_TRUE(gate.acquire(0, "pid", 0).is_granted);
  EXPECT_TRUE(gate.acquire(0, "pid", 0).is_granted);  // again by the same one
  const LeaseAnswer refused = gate.acquire(0, "joystick", 0);
  EXPECT_FALSE(refused.is_granted);
  EXPECT_EQ(refused.holder, "pid");
  EXPECT_NE(refused.reason.find("Input_Slew is held by 'pid'"), std::string::npos) << refused.reason;
  EXPECT_FALSE(gate.write(0, "joystick", 1, 0, 0));
  EXPECT_EQ(gate.rejected_no_lease(), 1u);
  EXPECT_TRUE(gate.release(0, "pid").is_granted);
  EXPECT_TRUE(gate.acquire(0, "joystick", 0).is_granted);
}

TEST(InputGate, ARepeatedAcquireOfAHeldChannelChangesNothing) {
  InputGate gate = crane_gate();
  ASSERT_TRUE(gate.acquire(1, "pid", 0).is_granted);
  gate.write(1, "pid", 0.5, 0, 10 * kMs);
  EXPECT_TRUE(gate.acquire(1, "pid", 150 * kMs).is_granted);
  gate.advance(0, held({0, 0}), 151 * kMs);
  EXPECT_NEAR(gate.control(1), 250, 1e-12);
  // and is a sign of life
  gate.advance(1, held({0, 0}), 349 * kMs);
  EXPECT_NEAR(gate.control(1), 250, 1e-12);
  EXPECT_EQ(gate.went_neutral(), 0u);
}

TEST(InputGate, SilentControllerGoesToNeutralAndLaterLosesTheChannel) {
  InputGate gate = crane_gate();
  ASSERT_TRUE(gate.acquire(1, "pid", 0).is_granted);
  gate.write(1, "pid", 1, 0, 0);
  gate.advance(0, held({0, 0.5}), 199 * kMs);
  EXPECT_EQ(gate.control(1), 500);
  gate.advance(1, held({0, 0.5}), 201 * kMs);
  EXPECT_EQ(gate.control(1), 0) << "neutral, not the script: the channel is still held";
  EXPECT_EQ(gate.went_neutral(), 1u);
  EXPECT_EQ(gate.acquire(1, "joystick", 202 * kMs).holder, "pid");
  gate.advance(2, held({0, 0.5}), 5001 * kMs);
  EXPECT_EQ(gate.control(1), 250);
  EXPECT_TRUE(gate.acquire(1, "joystick", 5002 * kMs).is_granted);
}

TEST(InputGate, AControllerThatLosesItsChannelIsNamedOnce) {
  InputGate gate = crane_gate();
  ASSERT_TRUE(gate.acquire(0, "joystick", 0).is_granted);
  ASSERT_TRUE(gate.acquire(1, "pid", 0).is_granted);
  ASSERT_TRUE(gate.release(0, "joystick").is_granted);
  EXPECT_TRUE(gate.take_notices().empty());
  gate.advance(0, held({0, 0}), 5001 * kMs);
  std::vector<Notice> lost = gate.take_notices();
  ASSERT_EQ(lost.size(), 1u);
  EXPECT_EQ(lost[0].controller, "pid");
  EXPECT_EQ(lost[0].channel, 1u);
  EXPECT_NE(lost[0].reason.find("no value came for 5000 ms"), std::string::npos) << lost[0].reason;
  EXPECT_TRUE(gate.take_notices().empty());

  ASSERT_TRUE(gate.acquire(0, "joystick", 0).is_granted);
  gate.reset();
  lost = gate.take_notices();
  ASSERT_EQ(lost.size(), 1u);
  EXPECT_EQ(lost[0].controller, "joystick");
  EXPECT_NE(lost[0].reason.find("reset"), std::string::npos) << lost[0].reason;
}

TEST(InputGate, HolderOverridesTheScript) {
  InputGate gate = crane_gate();
  ASSERT_TRUE(gate.acquire(1, "pid", 0).is_granted);
  gate.write(1, "pid", -1, 3, 0);
  gate.advance(5, held({1, 1}), 0);
  EXPECT_EQ(gate.control(0), -500);  // script
  EXPECT_EQ(gate.control(1), -500);  // controller
  EXPECT_EQ(gate.age(1), 2u);
}

TEST(InputGate, DigitalInputIsZeroOrOne) {
  ChannelConfig horn;
  horn.name = "Horn";
  horn.is_digital = true;
  InputGate gate({horn}, GateConfig{}, milliseconds(1));
  gate.advance(0, held({0.4}), 0);
  EXPECT_EQ(gate.control(0), 0);
  gate.advance(1, held({0.6}), 0);
  EXPECT_EQ(gate.control(0), 1);
  gate.advance(2, held({-1}), 0);
  EXPECT_EQ(gate.control(0), 0);
}

TEST(InputGate, AWriteWithoutTheLeaseIsRefusedOnceASecondNamingTheHolder) {
  InputGate gate = crane_gate();
  ASSERT_TRUE(gate.acquire(1, "pid", 0).is_granted);
  // the channel is lost by silence, and the notice does not arrive
  gate.advance(0, held({0, 0}), 5001 * kMs);
  static_cast<void>(gate.take_notices());
  EXPECT_FALSE(gate.write(1, "pid", 1, 1, 5500 * kMs));
  EXPECT_FALSE(gate.answer_to_write(1, "pid", 5500 * kMs)) << "it may be on its way";
  std::optional<LeaseAnswer> answer = gate.answer_to_write(1, "pid", 7000 * kMs);
  ASSERT_TRUE(answer.has_value());
  EXPECT_FALSE(answer->is_granted);
  EXPECT_EQ(answer->holder, "");
  EXPECT_EQ(answer->reason, "'pid' does not hold channel Input_Lift: it is free; acquire it again to go on");
  EXPECT_FALSE(gate.answer_to_write(1, "pid", 7999 * kMs));
  ASSERT_TRUE(gate.acquire(1, "joystick", 8000 * kMs).is_granted);
  answer = gate.answer_to_write(1, "pid", 8000 * kMs);
  ASSERT_TRUE(answer.has_value());
  EXPECT_EQ(answer->holder, "joystick");
  EXPECT_NE(answer->reason.find("channel Input_Lift is held by 'joystick'"), std::string::npos) << answer->reason;
  // another channel has a refusal of its own, and the holder receives none
  EXPECT_TRUE(gate.answer_to_write(0, "pid", 8000 * kMs).has_value());
  EXPECT_FALSE(gate.answer_to_write(1, "joystick", 20'000 * kMs));
  EXPECT_FALSE(gate.answer_to_write(1, "", 20'000 * kMs));
}

TEST(InputGate, AWriteAfterAResetIsRefusedSinceTheChannelIsFree) {
  InputGate gate = crane_gate();
  ASSERT_TRUE(gate.acquire(1, "pid", 0).is_granted);
  gate.advance(0, held({0, 0}), kMs);
  gate.reset();
  EXPECT_FALSE(gate.answer_to_write(1, "pid", 2 * kMs)) << "written before the notice of the reset";
  EXPECT_TRUE(gate.answer_to_write(1, "pid", 1500 * kMs).has_value());
}

TEST(InputGate, FewRefusalsASecondAreSentHoweverManyWriteWithoutALease) {
  InputGate gate = crane_gate();
  int answered = 0;
  for (int i = 0; i < 10'000; ++i) {
    answered += gate.answer_to_write(0, "stranger" + std::to_string(i), 10'000 * kMs + i * 100'000).has_value() ? 1 : 0;
  }
  EXPECT_GE(answered, 16);
  EXPECT_LE(answered, 32);
}

// ---- two processes of one name --------------------------------------------------------------------------------

TEST(InputGate, ASecondProcessOfTheHoldersNameIsRefusedAndMovesNothing) {
  GateConfig config;
  config.see_writer = [](std::uint64_t writer) {
    return transport::WriterSight{false, writer == 7 ? "process 812 on crane2" : ""};
  };
  InputGate gate({channel("Lever", 1, 0)}, config, milliseconds(1));
  ASSERT_TRUE(gate.acquire(0, "pid", 0, 7).is_granted);
  EXPECT_TRUE(gate.acquire(0, "pid", 0, 7).is_granted);
  const LeaseAnswer refused = gate.acquire(0, "pid", 0, 8);
  EXPECT_FALSE(refused.is_granted);
  EXPECT_EQ(refused.holder, "pid");
  EXPECT_EQ(refused.reason,
            "channel Lever is held by another process named 'pid' (process 812 on crane2); give one of the two another "
            "name, or stop one");
  EXPECT_FALSE(gate.take_over(0, "pid", 0, 8).is_granted);
  EXPECT_FALSE(gate.release(0, "pid", kJoinStep, 8).is_granted);
  EXPECT_TRUE(gate.write(0, "pid", 0.5, 0, 0, kJoinStep, 7));
  EXPECT_FALSE(gate.write(0, "pid", -1, 0, 0, kJoinStep, 8));
  EXPECT_EQ(gate.rejected_no_lease(), 1u);
  gate.advance(0, held({0}), kMs);
  EXPECT_EQ(gate.raw(0), 0.5);
  const std::optional<LeaseAnswer> answer = gate.answer_to_write(0, "pid", 2000 * kMs, 8);
  ASSERT_TRUE(answer.has_value());
  EXPECT_EQ(answer->reason, refused.reason);
  // without the writer from the transport the processes are not distinguished
  EXPECT_TRUE(gate.write(0, "pid", 0.6, 0, 0));
  // when the first has fallen silent the second has it
  gate.advance(1, held({0}), 8000 * kMs);
  EXPECT_TRUE(gate.acquire(0, "pid", 8000 * kMs, 8).is_granted);
  EXPECT_FALSE(gate.write(0, "pid", -1, 1, 8000 * kMs, kJoinStep, 7));
}

TEST(InputGate, ARestartedControllerHasItsChannelAtOnceWhenItsOldProcessIsSeenToBeGone) {
  bool has_left = false;
  GateConfig config;
  config.see_writer = [&has_left](std::uint64_t) { return transport::WriterSight{.has_left = has_left}; };
  InputGate gate({channel("Lever", 1, 0)}, config, milliseconds(1));
  ASSERT_TRUE(gate.acquire(0, "pid", 0, 7).is_granted);
  gate.write(0, "pid", 0.5, 0, 0, kJoinStep, 7);
  EXPECT_FALSE(gate.acquire(0, "pid", 10 * kMs, 8).is_granted);
  has_left = true;
  EXPECT_FALSE(gate.acquire(0, "joystick", 10 * kMs, 9).is_granted) << "another name waits for the silence";
  EXPECT_TRUE(gate.acquire(0, "pid", 10 * kMs, 8).is_granted);
  gate.advance(0, held({0}), 11 * kMs);
  EXPECT_EQ(gate.raw(0), 0) << "the new one has written no value";
  EXPECT_TRUE(gate.write(0, "pid", -0.5, 1, 12 * kMs, kJoinStep, 8));
}

// ---- taking over ----------------------------------------------------------------------------------------------

TEST(InputGate, OnlyTheSupervisorTakesAChannelFromItsHolder) {
  ChannelConfig lever = channel("Lever", 1, 0);
  lever.supervisor = "instructor";
  ChannelConfig other = channel("Other", 1, 0);
  InputGate gate({lever, other}, GateConfig{}, milliseconds(1));
  ASSERT_TRUE(gate.acquire(0, "trainee", 0).is_granted);
  ASSERT_TRUE(gate.acquire(1, "trainee", 0).is_granted);
  gate.write(0, "trainee", 0.5, 0, 0);

  EXPECT_FALSE(gate.acquire(0, "instructor", 0).is_granted) << "it did not request a take-over";
  const LeaseAnswer stranger = gate.take_over(0, "stranger", 0);
  EXPECT_FALSE(stranger.is_granted);
  EXPECT_EQ(stranger.holder, "trainee");
  EXPECT_EQ(stranger.reason,
            "channel Lever is held by 'trainee', and only 'instructor' may take it over (Lever.supervisor)");
  EXPECT_EQ(gate.take_over(1, "instructor", 0).reason,
            "channel Other is held by 'trainee', and it has no supervisor: name a controller in Other.supervisor of "
            "the scene");
  EXPECT_TRUE(gate.take_notices().empty());

  EXPECT_TRUE(gate.take_over(0, "instructor", 0).is_granted);
  const std::vector<Notice> lost = gate.take_notices();
  ASSERT_EQ(lost.size(), 1u);
  EXPECT_EQ(lost[0].controller, "trainee");
  EXPECT_FALSE(lost[0].has_channel);
  EXPECT_EQ(lost[0].reason, "'instructor' has taken over channel Lever");
  gate.advance(0, held({0, 0}), 0);
  EXPECT_EQ(gate.raw(0), 0.5) << "the value stays until the new holder writes";
  EXPECT_FALSE(gate.write(0, "trainee", 1, 0, 0));
  EXPECT_TRUE(gate.write(0, "instructor", -0.5, 0, 0));
  gate.advance(1, held({0, 0}), 0);
  EXPECT_EQ(gate.raw(0), -0.5);
}

TEST(InputGate, TakingOverAFreeChannelIsAcquiringIt) {
  InputGate gate = crane_gate();
  EXPECT_TRUE(gate.take_over(0, "any", 0).is_granted);
  EXPECT_TRUE(gate.take_over(0, "any", 0).is_granted);
}

// ---- lockstep -------------------------------------------------------------------------------------------------

TEST(InputGate, OfTwoValuesForOneStepTheFirstCountsSinceTheClockMustNotDecide) {
  ChannelConfig lever = channel("Lever", 1, 0);
  lever.controller = scene::ControllerMode::lockstep;
  InputGate gate({lever}, GateConfig{}, milliseconds(1));
  ASSERT_TRUE(gate.acquire(0, "pid", 0).is_granted);
  gate.advance(0, held({0}), 0);
  EXPECT_GT(gate.awaited(1).ns, 0);
  gate.write(0, "pid", 0.5, 1, 0, 0);
  gate.write(0, "pid", -1, 1, 0, 0);
  EXPECT_EQ(gate.awaited(1).ns, 0);
  gate.advance(1, held({0}), 0);
  EXPECT_EQ(gate.raw(0), 0.5);
  EXPECT_EQ(gate.based_on(0), 0);
}

TEST(InputGate, ValuesOfStepsThatNoTickTakesAreCountedAndNotKept) {
  ChannelConfig lever = channel("Lever", 1, 0);
  lever.controller = scene::ControllerMode::lockstep;
  lever.delay = 3;
  GateConfig every_fifth;
  every_fifth.variables_every = 5;
  InputGate gate({lever}, every_fifth, milliseconds(1));
  ASSERT_TRUE(gate.acquire(0, "pid", 0).is_granted);
  for (const StepIndex based_on : {-1, 0, 4, 7, 15, 1000}) EXPECT_FALSE(gate.write(0, "pid", 1, 12, 0, based_on));
  EXPECT_EQ(gate.rejected_late(), 6u);
  EXPECT_TRUE(gate.write(0, "pid", 1, 12, 0, 5));
  EXPECT_TRUE(gate.write(0, "pid", 1, 12, 0, 10));
  EXPECT_FALSE(gate.write(0, "pid", kNan, 12, 0, 10));  // neither the first one nor a number
}

TEST(InputGate, TwoLockstepChannelsAreAwaitedEach) {
  ChannelConfig slew = channel("Slew", 1, 0), lift = channel("Lift", 1, 0);
  slew.controller = lift.controller = scene::ControllerMode::lockstep;
  slew.wait = milliseconds(30);
  lift.wait = milliseconds(70);
  lift.delay = 2;
  InputGate gate({slew, lift}, GateConfig{}, milliseconds(1));
  EXPECT_EQ(gate.vacant(), 0);
  ASSERT_TRUE(gate.acquire(0, "a", 0).is_granted);
  EXPECT_EQ(gate.vacant(), 1);
  ASSERT_TRUE(gate.acquire(1, "b", 0).is_granted);
  EXPECT_EQ(gate.vacant(), -1);
  EXPECT_EQ(gate.awaited(0).ns, 0);
  EXPECT_EQ(gate.awaited(1).ns, 30 * kMs);
  EXPECT_EQ(gate.awaited(2).ns, 70 * kMs);
  gate.write(1, "b", 0.5, 2, 0, 0);
  EXPECT_EQ(gate.awaited(2).ns, 30 * kMs);
}

TEST(InputGate, AReleaseTakesEffectAfterTheTicksOfItsLastValue) {
  ChannelConfig lever = channel("Lever", 1, 0);
  lever.controller = scene::ControllerMode::lockstep;
  lever.delay = 2;
  InputGate gate({lever}, GateConfig{}, milliseconds(1));
  ASSERT_TRUE(gate.acquire(0, "pid", 0).is_granted);
  gate.advance(0, held({0.3}), 0);
  gate.write(0, "pid", 0.5, 1, 0, 0);
  gate.write(0, "pid", 0.6, 1, 0, 1);
  EXPECT_TRUE(gate.release(0, "pid", 1).is_granted);
  EXPECT_FALSE(gate.write(0, "pid", 0.7, 1, 0, 1)) << "it has released the channel after its last value";
  for (StepIndex n = 1; n < 4; ++n) {
    EXPECT_EQ(gate.awaited(n).ns, 0);
    gate.advance(n, held({0.3}), 0);
    EXPECT_EQ(gate.raw(0), n == 1 ? 0 : n == 2 ? 0.5 : 0.6) << n;
  }
  gate.advance(4, held({0.3}), 0);
  EXPECT_EQ(gate.raw(0), 0.3) << "the script's";
  EXPECT_TRUE(gate.acquire(0, "other", 0).is_granted);
  // a notice for the user alone reports that it has no holder
  const std::vector<Notice> notices = gate.take_notices();
  ASSERT_EQ(notices.size(), 1u);
  EXPECT_EQ(notices[0].controller, "");
  EXPECT_EQ(notices[0].reason,
            "'pid' has released channel Lever (controller: lockstep): it is free from tick 4 on, and no tick waits for "
            "a controller until one is in step with it");
}

TEST(InputGate, AControllerThatLeavesBeforeItHasAnsweredABlockIsNotWaitedFor) {
  ChannelConfig lever = channel("Lever", 1, 0);
  lever.controller = scene::ControllerMode::lockstep;
  InputGate gate({lever}, GateConfig{}, milliseconds(1));
  ASSERT_TRUE(gate.acquire(0, "pid", 0).is_granted);
  gate.advance(0, held({0}), 0);
  // it has answered the block of step 0 and read that of step 1
  gate.write(0, "pid", 0.5, 1, 0, 0);
  gate.advance(1, held({0}), 0);
  EXPECT_TRUE(gate.release(0, "pid", 0).is_granted);
  EXPECT_EQ(gate.awaited(2).ns, 0);
  gate.advance(2, held({0.3}), 0);
  EXPECT_EQ(gate.raw(0), 0.3);
  EXPECT_EQ(gate.fell_out_of_step(), 0u);
}

TEST(InputGate, ALockstepChannelOfASavedSessionIsAwaitedAsAtStepZero) {
  ChannelConfig lever = channel("Lever", 1, 0);
  lever.controller = scene::ControllerMode::lockstep;
  lever.delay = 3;
  InputGate saved({lever}, GateConfig{}, milliseconds(1)), gate({lever}, GateConfig{}, milliseconds(1));
  std::vector<std::byte> state;
  StateWriter writer(state, {1, 1});
  saved.save(writer);
  writer.finish();
  StateReader reader(state, {1, 1});
  gate.load(reader, 700);
  ASSERT_TRUE(reader.finish("io").is_ok());
  EXPECT_EQ(gate.vacant(), 0);
  ASSERT_TRUE(gate.acquire(0, "pid", 0).is_granted);
  for (StepIndex n = 700; n < 703; ++n) {
    EXPECT_EQ(gate.awaited(n).ns, 0) << "no step of this session is three before tick " << n;
    gate.advance(n, held({0}), 0);
  }
  EXPECT_GT(gate.awaited(703).ns, 0);
  EXPECT_TRUE(gate.write(0, "pid", 0.5, 703, 0, 700));
  EXPECT_EQ(gate.awaited(703).ns, 0);
  gate.advance(703, held({0}), 0);
  EXPECT_EQ(gate.raw(0), 0.5);
  EXPECT_TRUE(gate.take_notices().empty());
}

TEST(InputGate, NoStateBringsAValueThatIsNotFinite) {
  InputGate gate = crane_gate();
  std::vector<std::byte> state;
  StateWriter writer(state, {1, 1});
  writer.number(kNan);
  for (int i = 0; i < 5; ++i) writer.number(0.0);
  writer.finish();
  StateReader reader(state, {1, 1});
  gate.load(reader, 700);
  EXPECT_FALSE(reader.finish("io").is_ok());
}

TEST(InputGate, ALockstepChannelThatIsTakenOverKeepsItsValueUntilTheNewHolderIsInStep) {
  ChannelConfig lever = channel("Lever", 1, 0);
  lever.controller = scene::ControllerMode::lockstep;
  lever.supervisor = "instructor";
  InputGate gate({lever}, GateConfig{}, milliseconds(1));
  const auto advance = [&gate](StepIndex n) { gate.advance(n, held({0}), n * kMs); };
  ASSERT_TRUE(gate.acquire(0, "trainee", 0).is_granted);
  for (StepIndex n = 0; n < 5; ++n) {
    advance(n);
    gate.write(0, "trainee", 0.5, n + 1, n * kMs, n);
  }
  ASSERT_TRUE(gate.take_over(0, "instructor", 5 * kMs).is_granted);
  EXPECT_EQ(gate.awaited(5).ns, 0) << "what the old holder sent is not the new one's";
  advance(5);
  EXPECT_EQ(gate.raw(0), 0.5);
  static_cast<void>(gate.take_notices());
  gate.write(0, "instructor", -0.5, 6, 6 * kMs, 5);
  advance(6);
  EXPECT_EQ(gate.raw(0), -0.5);
  EXPECT_GT(gate.awaited(7).ns, 0);
  const std::vector<Notice> notices = gate.take_notices();
  ASSERT_EQ(notices.size(), 1u);
  EXPECT_EQ(notices[0].reason,
            "'instructor' is in step from tick 6 on; channel Lever had been without it since tick 5");
}

TEST(InputGate, NoSequenceOfMessagesPutsAValueOutOfRangeOrInTooEarlyATick) {
  std::mt19937_64 random(1);
  const auto below = [&random](std::uint64_t n) { return static_cast<std::int64_t>(random() % n); };
  const std::string names[] = {"a", "b", "c", ""};
  for (int session = rounds(30, 1000); session > 0; --session) {
    std::vector<ChannelConfig> channels(3);
    for (std::size_t i = 0; i < channels.size(); ++i) {
      channels[i].name = "C" + std::to_string(i);
      channels[i].is_digital = i == 2;
      channels[i].controller = below(2) == 0 ? scene::ControllerMode::sampled : scene::ControllerMode::lockstep;
      channels[i].delay = 1 + below(5);
      channels[i].supervisor = below(2) == 0 ? "" : "b";
    }
    GateConfig config;
    config.variables_every = 1 + below(4);
    InputGate gate(channels, config, milliseconds(1));
    std::int64_t now_ns = 0;
    StepIndex n = 0;
    for (int call = 0; call < 2000; ++call) {
      now_ns += below(50) * kMs;
      const auto channel = static_cast<std::size_t>(below(3));
      const std::string& controller = names[below(4)];
      const double value = below(10) == 0 ? kNan : static_cast<double>(below(5) - 2);
      switch (below(8)) {
        case 0:
          static_cast<void>(gate.acquire(channel, controller, now_ns, below(3)));
          break;
        case 1:
          static_cast<void>(gate.take_over(channel, controller, now_ns, below(3)));
          break;
        case 2:
          static_cast<void>(gate.release(channel, controller, n + below(8) - 6, below(3)));
          break;
        case 3:
          if (below(100) == 0) {
            gate.reset();
            n = 0;
          }
          gate.excuse(milliseconds(below(100)), now_ns);
          break;
        case 4:
        case 5:
          if (!gate.write(channel, controller, value, n, now_ns, n + below(10) - 8, below(3))) {
            static_cast<void>(gate.answer_to_write(channel, controller, now_ns, below(3)));
          }
          break;
        default:
          gate.advance(n, held({0, 0.5, 1}), now_ns);
          for (std::size_t i = 0; i < gate.size(); ++i) {
            ASSERT_GE(gate.raw(i), i == 2 ? 0 : -1);
            ASSERT_LE(gate.raw(i), 1);
            const StepIndex newest =
                channels[i].controller == scene::ControllerMode::lockstep ? n - channels[i].delay : n;
            ASSERT_LE(gate.based_on(i), std::max(newest, kJoinStep)) << "channel " << i << " tick " << n;
          }
          ++n;
      }
      if (call % 100 == 0) static_cast<void>(gate.take_notices());
    }
  }
}

}  // namespace input_gate_test
}  // namespace slew::io_node
