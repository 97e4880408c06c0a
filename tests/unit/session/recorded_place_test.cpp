// SPDX-License-Identifier: Apache-2.0
// Times of a recording whose session was reset and loaded: three epochs on one line.
#include "session/recorded_place.h"

#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <vector>

#include "core/failure.h"
#include "node/identity.h"
#include "recording/writer.h"
#include "tests/support/temporary_folder.h"
#include "transport/cdr/codec.h"
#include "transport/topics.h"

namespace slew::session {
namespace recorded_place_test {

using wire::Phase;
using wire::Topic;

constexpr std::uint64_t kMs = 1'000'000;

class Place : public ::testing::Test {
 protected:
  Place() {
    recording::SessionIdentity identity;
    identity.communication_step = milliseconds(1);
    EXPECT_EQ(recording::Writer::create(path_, identity, {}, writer_).text, "");
    for (const Topic topic : {Topic::tick, Topic::variables}) {
      EXPECT_EQ(
          writer_->add_channel({std::string(node::to_text(topic)), "slewring::Any", "", {}}, channels_[topic]).text,
          "");
    }
  }
  template <typename Message>
  void put(Topic topic, std::uint32_t epoch, StepIndex step, Phase phase) {
    Message message;
    message.header.epoch = epoch;
    message.header.phase = phase;
    message.header.step = step;
    std::vector<std::byte> bytes;
    ASSERT_TRUE(transport::encode(message, bytes));
    ASSERT_EQ(writer_->write(channels_[topic], {epoch, step, 0, 0}, bytes).text, "");
  }
  // INIT, then ticks of each step and variables of each fifth
  void run(std::uint32_t epoch, StepIndex first, StepIndex last) {
    put<wire::Tick>(Topic::tick, epoch, kJoinStep, Phase::init);
    for (StepIndex step = first; step <= last; ++step) {
      put<wire::Tick>(Topic::tick, epoch, step, Phase::running);
      if (step % 5 == 0) put<wire::VariableBlock>(Topic::variables, epoch, step, Phase::running);
    }
  }
  // 0 to 200 ms of epoch 0; 201 to 301 ms are 500 to 600 ms of epoch 1, a loaded state; 302 to 402 ms are 0 to 100 ms
  // of epoch 2
  void run_three() {
    run(0, 0, 200);
    writer_->begin_epoch(1, 500);
    run(1, 500, 600);
    run(2, 0, 100);
  }
  std::unique_ptr<recording::Reader> recorded() {
    EXPECT_EQ(writer_->close({}).text, "");
    std::unique_ptr<recording::Reader> reader;
    EXPECT_EQ(recording::Reader::open(path_, reader).text, "");
    return reader;
  }

 private:
  testing::TemporaryFolder folder_{"place"};
  std::filesystem::path path_ = folder_.path() / "session.mcap";

 protected:
  std::unique_ptr<recording::Writer> writer_;
  std::map<Topic, recording::ChannelId> channels_;
};

TEST_F(Place, OfATimeIsTheStepThatIsRecordedThere) {
  run_three();
  const auto reader = recorded();
  EXPECT_EQ(place_of(*reader, 0), (RecordedPlace{0, 0}));
  EXPECT_EQ(place_of(*reader, 150 * kMs), (RecordedPlace{0, 150}));
  EXPECT_EQ(place_of(*reader, 200 * kMs), (RecordedPlace{0, 200}));
  EXPECT_EQ(place_of(*reader, 201 * kMs), (RecordedPlace{1, 500}));
  EXPECT_EQ(place_of(*reader, 250 * kMs - 1), (RecordedPlace{1, 549}));  // the next step
  EXPECT_EQ(place_of(*reader, 301 * kMs), (RecordedPlace{1, 600}));
  EXPECT_EQ(place_of(*reader, 302 * kMs), (RecordedPlace{2, 0}));
  EXPECT_EQ(place_of(*reader, 402 * kMs), (RecordedPlace{2, 100}));
  // the sample behind the last tick
  EXPECT_EQ(place_of(*reader, 403 * kMs), (RecordedPlace{2, 101}));
  EXPECT_THROW(static_cast<void>(place_of(*reader, 404 * kMs + 1)), Failure);
}

TEST_F(Place, InAGapOfTheTicksIsRefused) {
  run(0, 0, 20);
  run(0, 40, 60);
  const auto reader = recorded();
  EXPECT_EQ(place_of(*reader, 40 * kMs), (RecordedPlace{0, 40}));
  EXPECT_THROW(static_cast<void>(place_of(*reader, 30 * kMs)), Failure);
}

TEST_F(Place, EachEpochHasItsTimes) {
  run_three();
  const auto reader = recorded();
  const std::vector<EpochTimes> all = epoch_times(*reader, {});
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[0].to_ns, 200 * kMs);
  EXPECT_EQ(all[1].from_ns, 201 * kMs);
  EXPECT_EQ(all[1].first_step, 500);
  EXPECT_EQ(all[2].from_ns, 302 * kMs);
  try {
    static_cast<void>(only_epoch(*reader, {}));
    ADD_FAILURE() << "three epochs are no one line";
  } catch (const Failure& failure) {
    EXPECT_NE(std::string(failure.what()).find("epoch 1 from 0.201 s to 0.301 s"), std::string::npos) << failure.what();
  }
  // a part of one epoch: its first block there
  const EpochTimes part = only_epoch(*reader, {.from_ns = 210 * kMs, .to_ns = 301 * kMs});
  EXPECT_EQ(part.epoch, 1u);
  EXPECT_EQ(part.first_step, 510);
  EXPECT_EQ(part.from_ns, 211 * kMs);
}

// a session that goes on from a saved state, or a recorder that came late: INIT has no time of its own
TEST_F(Place, ARecordingBeginsWithItsFirstStep) {
  run(0, 700, 800);
  const auto reader = recorded();
  EXPECT_EQ(reader->statistics().start_time, 0u);
  EXPECT_EQ(begin_time_ns(*reader), 700 * kMs);
  EXPECT_EQ(reader->statistics().end_time, 800 * kMs);
}

}  // namespace recorded_place_test
}  // namespace slew::session
