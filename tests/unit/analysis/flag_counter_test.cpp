// SPDX-License-Identifier: Apache-2.0
// Counts of what samples report.
#include "node/flag_counter.h"

#include <gtest/gtest.h>

#include "analysis/run_report/flag_report.h"
#include "core/step_report.h"

namespace slew::analysis {
namespace flag_counter_test {

using node::FlagCounter;

const OffenderNames kNames = {{"Tank", "Line"}, {"Gap", "Hit"}, {"Ball_Floor", "Ball_Plate"}};

void take(FlagCounter& flags, StepIndex step, StepFlag flag, std::uint32_t epoch = 1,
          wire::Role role = wire::Role::hydraulics) {
  wire::Header header;
  header.role = role;
  header.phase = wire::Phase::running;
  header.epoch = epoch;
  header.step = step;
  wire::SampleState state;
  state.flags = static_cast<std::uint32_t>(flag);
  state.offender = 1;
  state.used_step = step - 1;
  flags.take(header, state);
}

TEST(FlagCounter, ARepeatedSampleIsCountedOnce) {
  FlagCounter flags;
  for (const StepIndex step : {0, 1, 2, 2, 1, 3}) take(flags, step, StepFlag::beyond_oil_law);
  EXPECT_EQ(flags.missed(0), 0u);
  EXPECT_EQ(flag_sentences(flags, milliseconds(1), kNames),
            std::vector<std::string>{
                "hydraulics: Line: a pressure was beyond the range of the oil's law (1000 bar) in 4 steps, first at "
                "0; limit it: a relief valve on the line, a lower load or setting"});
}

TEST(FlagCounter, SamplesThatDidNotArriveAreCountedAndANewEpochIsNoGap) {
  FlagCounter flags;
  for (const StepIndex step : {3, 4, 7}) take(flags, step, StepFlag{});
  for (const StepIndex step : {0, 1}) take(flags, step, StepFlag{}, 2);
  EXPECT_EQ(flags.missed(0), 4u);  // 1 and 2, 5 and 6
  EXPECT_EQ(flags.missed(3), 2u);
  EXPECT_TRUE(flag_sentences(flags, milliseconds(1), {}).empty());
}

TEST(FlagCounter, NamesTheLineThatCavitates) {
  FlagCounter flags;
  for (const StepIndex step : {1, 2}) take(flags, step, StepFlag::cavitating);
  EXPECT_EQ(flag_sentences(flags, milliseconds(1), kNames),
            std::vector<std::string>{"hydraulics: Line: the oil cavitated in 2 steps, first at 1 ms; look at the "
                                     "pressures near zero"});
}

TEST(FlagCounter, NamesTheContactWhoseShapesPassed) {
  FlagCounter flags;
  for (const StepIndex step : {1, 2}) take(flags, step, StepFlag::not_converged, 1, wire::Role::mechanics);
  EXPECT_EQ(
      flag_sentences(flags, milliseconds(1), kNames),
      std::vector<std::string>{
          "mechanics: Ball_Plate: its shapes passed through each other between two instants, or faster than a "
          "sub-step follows in 2 steps, first at 1 ms; choose a smaller session.step or mechanics.max_substep, or "
          "a thicker shape"});
}

// sensors publish at every k-th step
TEST(FlagCounter, NamesTheSensorWhoseSearchFailed) {
  FlagCounter flags;
  take(flags, 20, StepFlag{}, 1, wire::Role::sensor);
  for (const StepIndex step : {30, 40}) take(flags, step, StepFlag::not_converged, 1, wire::Role::sensor);
  EXPECT_EQ(flags.missed(0), 0u);
  EXPECT_EQ(flag_sentences(flags, milliseconds(1), kNames),
            std::vector<std::string>{
                "sensor: Hit: no distance was found, or a body turned by half a turn or more between two samples in 2 "
                "steps, first at 30 ms; lower recording.every, or look for a body that leaves the machine"});
}

TEST(FlagCounter, ComesBackFromItsLine) {
  FlagCounter flags;
  for (const StepIndex step : {3, 4, 7}) take(flags, step, StepFlag::cavitating);
  take(flags, 8, StepFlag::large_deflection);
  const std::optional<FlagCounter> read = FlagCounter::of_text(flags.text());
  ASSERT_TRUE(read);
  EXPECT_EQ(read->text(), flags.text());
  EXPECT_EQ(flag_sentences(*read, milliseconds(1), kNames), flag_sentences(flags, milliseconds(1), kNames));
  EXPECT_TRUE(flags.is_in_order());
  take(flags, 5, StepFlag::cavitating);
  EXPECT_FALSE(flags.is_in_order());
  for (const char* broken : {"", "1 2", "1 9 0 0 0 0 0 0 0 0", "x"})
    EXPECT_FALSE(FlagCounter::of_text(broken)) << broken;
}

}  // namespace flag_counter_test
}  // namespace slew::analysis
