// SPDX-License-Identifier: Apache-2.0
// Extent of a recording without a gap, and its missing messages.
#include "session/recorded_extent.h"

#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <vector>

#include "node/identity.h"
#include "recording/writer.h"
#include "session/recorded.h"
#include "tests/support/temporary_folder.h"
#include "transport/cdr/codec.h"
#include "transport/topics.h"

namespace slew::session {
namespace recorded_extent_test {

using wire::Phase;
using wire::Role;
using wire::Topic;

// A recording that is written message by message.
class Extent : public ::testing::Test {
 protected:
  Extent() {
    recording::SessionIdentity identity;
    identity.communication_step = milliseconds(1);
    EXPECT_EQ(recording::Writer::create(path_, identity, {}, writer_).text, "");
    for (const Topic topic :
         {Topic::tick, Topic::mechanism, Topic::actuators, Topic::flexible, Topic::elastic, Topic::state}) {
      EXPECT_EQ(
          writer_->add_channel({std::string(node::to_text(topic)), "slewring::Any", "", {}}, channels_[topic]).text,
          "");
    }
  }

  void write_message(Topic topic, StepIndex step, Phase phase = Phase::running) {
    wire::Header header;
    header.epoch = epoch_;
    header.phase = phase;
    header.step = step;
    std::vector<std::byte> bytes;
    const auto encoded = [&](auto message) {
      message.header = header;
      return transport::encode(message, bytes);
    };
    ASSERT_TRUE(topic == Topic::tick        ? encoded(wire::Tick{})
                : topic == Topic::mechanism ? encoded(wire::MechanismMessage{})
                : topic == Topic::actuators ? encoded(wire::ActuatorMessage{})
                : topic == Topic::flexible  ? encoded(wire::FlexibleMessage{})
                : topic == Topic::elastic   ? encoded(wire::ElasticMessage{})
                                            : encoded(wire::StatePart{}));
    ASSERT_EQ(writer_->write(channels_[topic], {epoch_, step, 0, 0}, bytes).text, "");
  }
  // ticks and samples of steps first .. last
  void run(StepIndex first, StepIndex last) {
    for (StepIndex step = first; step <= last; ++step) {
      for (const Topic topic : {Topic::tick, Topic::mechanism, Topic::actuators}) write_message(topic, step);
    }
  }

  std::unique_ptr<recording::Reader> recorded() {
    EXPECT_EQ(writer_->close({}).text, "");
    std::unique_ptr<recording::Reader> reader;
    EXPECT_EQ(recording::Reader::open(path_, reader).text, "");
    return reader;
  }
  RecordedExtent extent() { return recorded_extent(*recorded()); }

  std::uint32_t epoch_ = 0;

 private:
  testing::TemporaryFolder folder_{"extent"};
  std::filesystem::path path_ = folder_.path() / "session.mcap";
  std::unique_ptr<recording::Writer> writer_;
  std::map<Topic, recording::ChannelId> channels_;
};

TEST_F(Extent, OfAWholeSessionReachesFromItsFirstStepToItsLast) {
  write_message(Topic::mechanism, kJoinStep, Phase::init);
  run(0, 300);
  const RecordedExtent whole = extent();
  EXPECT_EQ(whole.first_step, 0);
  EXPECT_EQ(whole.complete_to, 300);
  EXPECT_EQ(whole.last_step, 300);
  EXPECT_EQ(whole.lost, 0u);
}

TEST_F(Extent, OfARecordingThatBeginsWithStatesBeginsWithTheirStep) {
  write_message(Topic::state, 700);
  run(700, 1600);
  const RecordedExtent late = extent();
  EXPECT_EQ(late.first_step, 700);
  EXPECT_EQ(late.complete_to, 1600);
  EXPECT_EQ(late.lost, 0u);
}

TEST_F(Extent, EndsInFrontOfTheFirstGapHoweverLongItIs) {
  write_message(Topic::state, 700);
  run(700, 720);
  run(722, 730);
  run(20'000, 20'010);
  const RecordedExtent torn = extent();
  EXPECT_EQ(torn.complete_to, 720);
  EXPECT_EQ(torn.last_step, 20'010);
  EXPECT_EQ(torn.lost, 3u * (1 + 20'000 - 731));
}

TEST_F(Extent, BeginsNotWithTheStatesThatFollowAGap) {
  write_message(Topic::mechanism, kJoinStep, Phase::init);
  run(0, 300);
  run(320, 400);
  write_message(Topic::state, 410);
  run(401, 500);
  const RecordedExtent torn = extent();
  EXPECT_EQ(torn.first_step, 0);
  EXPECT_EQ(torn.complete_to, 300);
  EXPECT_EQ(torn.lost, 3u * 19);
}

TEST_F(Extent, CountsTheFirstStepsThatAreMissingBehindTheStates) {
  write_message(Topic::state, 700);
  run(702, 710);
  const RecordedExtent torn = extent();
  EXPECT_EQ(torn.first_step, 700);
  EXPECT_EQ(torn.complete_to, 699);
  EXPECT_EQ(torn.lost, 6u);
}

TEST_F(Extent, OfEpochsIsThatOfTheNewestAndTheLossesOfAll) {
  write_message(Topic::mechanism, kJoinStep, Phase::init);
  run(0, 10);
  run(12, 20);
  epoch_ = 1;  // a reset
  write_message(Topic::tick, kJoinStep, Phase::init);
  run(0, 5);
  epoch_ = 2;  // `control load`
  write_message(Topic::tick, 400, Phase::init);
  run(400, 450);
  const RecordedExtent third = extent();
  EXPECT_EQ(third.epoch, 2u);
  EXPECT_EQ(third.first_step, 400);
  EXPECT_EQ(third.complete_to, 450);
  EXPECT_EQ(third.last_step, 450);
  EXPECT_EQ(third.lost, 3u);
}

TEST_F(Extent, CountsTheStepsOfAllEpochsAlsoWhereATickWasLost) {
  run(0, 10);
  run(12, 20);
  epoch_ = 1;
  run(400, 450);
  EXPECT_EQ(tick_span(*recorded()).steps, 21 + 51);
}

TEST_F(Extent, WithoutARecordedBeginIsCountedFromStepZero) {
  run(5, 10);
  const RecordedExtent headless = extent();
  EXPECT_FALSE(headless.first_step.has_value());
  EXPECT_EQ(headless.complete_to, -1);
  EXPECT_EQ(headless.lost, 15u);
}

TEST_F(Extent, OfOneNodeBeginsWithItsFirstTick) {
  for (StepIndex step = 0; step < 10; ++step) write_message(Topic::tick, step);
  const RecordedExtent alone = extent();
  EXPECT_EQ(alone.first_step, 0);
  EXPECT_EQ(alone.complete_to, 9);
}

TEST_F(Extent, HoldsTheSamplesOfFlexibleBodiesInTheirRhythm) {
  write_message(Topic::state, 820);
  run(820, 899);
  for (const StepIndex step : {820, 830, 840, 860, 890}) write_message(Topic::elastic, step);
  for (const StepIndex step : {820, 830, 840, 850, 860, 880}) write_message(Topic::flexible, step);
  const RecordedExtent slow = extent();
  EXPECT_EQ(slow.lost, 3u + 1u);
  EXPECT_EQ(slow.complete_to, 849);
  EXPECT_EQ(slow.last_step, 899);
}

TEST_F(Extent, HoldsTheSamplesOfFlexibleBodiesOfEveryStep) {
  write_message(Topic::elastic, kJoinStep, Phase::init);
  run(0, 20);
  for (StepIndex step = 0; step <= 20; ++step) {
    if (step != 7) write_message(Topic::elastic, step);
  }
  const RecordedExtent fast = extent();
  EXPECT_EQ(fast.lost, 1u);
  EXPECT_EQ(fast.complete_to, 6);
}

}  // namespace recorded_extent_test
}  // namespace slew::session
