// SPDX-License-Identifier: Apache-2.0
// A recording as the source of a gateway.
#include "view_node/recorded_source.h"

#include <gtest/gtest.h>

#include <cstring>
#include <fstream>

#include "core/json.h"
#include "node/identity.h"
#include "recording/writer.h"
#include "tests/support/temporary_folder.h"
#include "transport/cdr/codec.h"

namespace recorded_source_test {

using namespace slew;
using namespace slew::view_node;
using wire::Topic;

constexpr std::int64_t kBeginNs = 1'000'000'000, kSecondNs = 1'000'000'000;
constexpr StepIndex kSteps = 2000;

// One variable over two seconds, in many chunks.
class RecordedSourceTest : public ::testing::Test {
 protected:
  void SetUp() override {
    recording::SessionIdentity identity;
    identity.communication_step = milliseconds(1);
    recording::WriterLimits limits;
    limits.chunk_bytes = 4096;
    ASSERT_EQ(recording::Writer::create(path, identity, limits, writer).text, "");
    wire::SessionDescription session;
    session.name = "winch";
    session.step_ns = milliseconds(1).ns;
    wire::VariableDirectory directory;
    directory.total = 1;
    directory.entries.push_back({"Bag.mass", "kg"});
    for (const Topic topic : {Topic::session, Topic::variable_directory, Topic::variables}) {
      ASSERT_EQ(writer->add_channel({std::string(node::to_text(topic)), "slewring::Any", "", {}}, channels[topic]).text,
                "");
    }
    write(Topic::session, session, 0);
    write(Topic::variable_directory, directory, 0);
    for (StepIndex step = 0; step < kSteps; ++step) {
      wire::VariableBlock block;
      block.values.push_back(static_cast<double>(step));
      write(Topic::variables, block, step);
    }
    ASSERT_EQ(writer->close({}).text, "");
  }
  template <typename Message>
  void write(Topic topic, Message message, StepIndex step) {
    message.header.role = topic == Topic::session ? wire::Role::io : wire::Role::mechanics;
    message.header.phase = wire::Phase::running;
    message.header.step = step;
    std::vector<std::byte> bytes;
    ASSERT_TRUE(transport::encode(message, bytes));
    ASSERT_EQ(writer->write(channels[topic], {0, step, 0, 0}, bytes).text, "");
  }
  std::unique_ptr<recording::Reader> recorded() const {
    std::unique_ptr<recording::Reader> reader;
    EXPECT_EQ(recording::Reader::open(path, reader).text, "");
    return reader;
  }
  // Bytes in the middle of a chunk are others.
  void damage(const recording::ChunkIndexRecord& chunk) const {
    std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(static_cast<std::streamoff>(chunk.offset + chunk.length / 2));
    file << "damage";
  }
  // Texts of the events that a client receives.
  static std::string events_of(gateway::Gateway& gateway) {
    const gateway::ClientId client = gateway.connect().value();
    gateway.take_message(client, gateway::FrameType::text,
                         R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":3}]})", 1);
    std::string all;
    while (const auto frame = gateway.next_frame(client)) {
      if (frame->type == gateway::FrameType::binary && frame->body != nullptr) all += *frame->body + "\n";
    }
    gateway.disconnect(client);
    return all;
  }
  // Plays the whole recording.
  static void play(RecordedSource& source, gateway::Gateway& gateway) {
    ASSERT_TRUE(source.control({.is_paused = false, .speed = 1}, kBeginNs).is_ok());
    for (std::int64_t i = 0; i <= 30; ++i) {
      gateway.poll(source.view(), kBeginNs + i * kSecondNs / 10);
      source.poll(gateway, kBeginNs + i * kSecondNs / 10);
    }
  }

  slew::testing::TemporaryFolder folder{"recorded_source"};
  std::filesystem::path path = folder.path() / "session.mcap";
  std::unique_ptr<recording::Writer> writer;
  std::map<Topic, recording::ChannelId> channels;
};

gateway::Gateway gateway_of(RecordedSource& source) {
  gateway::GatewayDef def;
  def.playback = &source;
  def.range = source.range();
  return {std::move(def), scene::load_text("bodies:\n  A: {mass: 1 kg, inertia: [1, 1, 1]}\njoints:\n"
                                           "  J: {type: revolute, body2: A}\n",
                                           "winch")};
}

TEST_F(RecordedSourceTest, IsPlayedToItsEnd) {
  const auto reader = recorded();
  RecordedSource source(*reader);
  gateway::Gateway gateway = gateway_of(source);
  play(source, gateway);
  EXPECT_EQ(source.view().find("Bag.mass")->value, kSteps - 1);
  EXPECT_EQ(source.state(kBeginNs + 4 * kSecondNs).status, gateway::PlaybackStatus::ended);
  EXPECT_EQ(events_of(gateway).find("at byte"), std::string::npos);
}

// not that of the playback, which lies between two samples
TEST_F(RecordedSourceTest, ValuesHaveTheTimeOfTheirSample) {
  const auto reader = recorded();
  RecordedSource source(*reader);
  gateway::Gateway gateway = gateway_of(source);
  ASSERT_TRUE(source.control({.is_paused = false, .speed = 0.5}, kBeginNs).is_ok());
  gateway.poll(source.view(), kBeginNs);
  const gateway::ClientId client = gateway.connect().value();
  // behind the gateway's own four
  gateway.take_message(client, gateway::FrameType::text,
                       R"({"op":"subscribe","subscriptions":[{"id":7,"channelId":5}]})", kBeginNs);
  int messages = 0;
  for (std::int64_t i = 0; i < 60; ++i) {
    const std::int64_t now_ns = kBeginNs + i * 17'300'000;
    gateway.poll(source.view(), now_ns);
    source.poll(gateway, now_ns);
    while (const auto frame = gateway.next_frame(client)) {
      if (frame->type != gateway::FrameType::binary || frame->body == nullptr) continue;
      std::uint64_t time_ns = 0;  // behind the kind and the subscription
      ASSERT_GE(frame->head.size(), 13U);
      std::memcpy(&time_ns, frame->head.data() + 5, sizeof time_ns);
      EXPECT_EQ(static_cast<double>(time_ns), Json::parse(*frame->body).value().at("mass").number() * 1e6);
      ++messages;
    }
  }
  EXPECT_GT(messages, 50);
}

TEST_F(RecordedSourceTest, ADamagedPlaceIsAnEvent) {
  {
    const auto reader = recorded();
    ASSERT_GT(reader->chunks().size(), 4u);
    damage(reader->chunks()[reader->chunks().size() / 2]);
  }
  const auto reader = recorded();
  RecordedSource source(*reader);
  gateway::Gateway gateway = gateway_of(source);
  play(source, gateway);
  const double last = source.view().find("Bag.mass")->value;
  EXPECT_GT(last, 0);
  EXPECT_LT(last, kSteps - 1);
  EXPECT_EQ(source.state(kBeginNs + 4 * kSecondNs).status, gateway::PlaybackStatus::ended);
  const std::string events = events_of(gateway);
  EXPECT_NE(events.find("the messages in front of it were read"), std::string::npos) << events;
}

}  // namespace recorded_source_test
