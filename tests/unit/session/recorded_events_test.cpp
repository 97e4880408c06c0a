// SPDX-License-Identifier: Apache-2.0
// Output of `info --events` for requests, answers and leases in a recording.
#include "session/recorded_events.h"

#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "node/identity.h"
#include "recording/writer.h"
#include "tests/support/temporary_folder.h"
#include "transport/cdr/codec.h"
#include "transport/topics.h"

namespace slew::session {
namespace recorded_events_test {

using wire::Topic;

constexpr StepIndex kStep = 40;
constexpr std::uint64_t kRequest = 7;

wire::ControlRequest param_set() {
  return {"s", kRequest, wire::ControlAction::set_parameter, "Bag.mass", 1500.0, -1};
}

// io's answer in words, or without, as in recordings of protocol version 3
wire::ControlReply accepted(const std::string& text) {
  wire::ControlReply reply;
  reply.header.step = kStep;
  reply.request = kRequest;
  reply.is_accepted = true;
  reply.asked = text;
  return reply;
}

class Events : public ::testing::Test {
 protected:
  Events() {
    recording::SessionIdentity identity;
    identity.communication_step = milliseconds(1);
    identity.session_id = node::to_text(wire::SessionId{});
    EXPECT_EQ(recording::Writer::create(path_, identity, {}, writer_).text, "");
    for (const Topic topic : {Topic::session, Topic::variable_directory, Topic::variables, Topic::control_request,
                              Topic::control_reply, Topic::controller_lease}) {
      EXPECT_EQ(
          writer_->add_channel({std::string(node::to_text(topic)), "slewring::Any", "", {}}, channels_[topic]).text,
          "");
    }
  }

  template <typename Message>
  void write_message(const Message& message, StepIndex step = kStep) {
    std::vector<std::byte> bytes;
    ASSERT_TRUE(transport::encode(message, bytes));
    ASSERT_EQ(writer_->write(channels_[transport::kTopicOf<Message>], {0, step, 0, 0}, bytes).text, "");
  }

  std::vector<RecordedEvent> events() {
    EXPECT_EQ(writer_->close({}).text, "");
    std::unique_ptr<recording::Reader> reader;
    EXPECT_EQ(recording::Reader::open(path_, reader).text, "");
    return recorded_events(*reader);
  }

  std::vector<std::string> event_texts() {
    std::vector<std::string> texts;
    for (const RecordedEvent& event : events()) {
      EXPECT_EQ(event.step, kStep);
      texts.push_back(event.text);
    }
    return texts;
  }

  // A session of which the mechanics publishes the ball's height, and one lamp above 1 m.
  void write_session(const std::string& variable) {
    wire::SessionDescription session;
    session.header.phase = wire::Phase::running;
    session.name = "s";
    session.step_ns = 1'000'000;
    session.scene_name = "lamp";
    session.scene_text =
        "bodies:\n  Ball: {mass: 2 kg, inertia: [0.1, 0.1, 0.1]}\njoints:\n  Free: {type: floating, body2: Ball}\n"
        "outputs:\n  Lamp: {type: switched, condition: Ball.center_of_mass.y > 1 m, hysteresis: 0.1 m}\n";
    write_message(session);
    wire::VariableDirectory directory;
    directory.header.role = wire::Role::mechanics;
    directory.header.phase = wire::Phase::running;
    directory.entries = {{variable, "m"}};
    directory.total = 1;
    write_message(directory);
  }
  void write_height(StepIndex step, double height) {
    wire::VariableBlock block;
    block.header.role = wire::Role::mechanics;
    block.header.phase = wire::Phase::running;
    block.header.step = step;
    block.values.push_back(height);
    write_message(block, step);
  }

 private:
  testing::TemporaryFolder folder_{"events"};
  std::filesystem::path path_ = folder_.path() / "session.mcap";
  std::unique_ptr<recording::Writer> writer_;
  std::map<Topic, recording::ChannelId> channels_;
};

TEST_F(Events, HaveTheTextOfARequestThatWasNotRecorded) {
  write_message(accepted(node::to_text(param_set())));
  EXPECT_EQ(event_texts(), std::vector{node::to_text(param_set()) + " accepted"});
}

TEST_F(Events, OfAnEarlierRecordingNameTheRequest) {
  write_message(param_set());
  write_message(accepted(""));
  EXPECT_EQ(event_texts(), std::vector{node::to_text(param_set()) + " accepted"});
}

TEST_F(Events, ListAResentReplyOnce) {
  write_message(accepted(node::to_text(param_set())));
  write_message(accepted(node::to_text(param_set())));
  EXPECT_EQ(event_texts().size(), 1u);
}

TEST_F(Events, OfAResetOrLoadAreInTheEpochThatItBegins) {
  wire::ControlReply reply;
  reply.header.epoch = 2;
  std::vector<std::string> expected;
  for (const std::string asked : {"pause", "reset", "load"}) {
    for (const bool is_accepted : {true, false}) {
      ++reply.request;
      reply.asked = asked;
      reply.is_accepted = is_accepted;
      write_message(reply);
      const bool begins_epoch = is_accepted && asked != "pause";
      expected.push_back(asked + (is_accepted ? " accepted" : " refused") + (begins_epoch ? " 3" : " 2"));
    }
  }
  std::vector<std::string> found;
  for (const RecordedEvent& event : events()) found.push_back(event.text + " " + std::to_string(event.epoch));
  EXPECT_EQ(found, expected);
}

TEST_F(Events, AreNoReadsUnlessRefused) {
  wire::ControlRequest read = param_set();
  read.action = wire::ControlAction::get_parameter;
  write_message(read);
  write_message(accepted(""));  // of an earlier recording
  wire::ControlReply reply = accepted("get Bag.mass");
  reply.request = kRequest + 1;
  write_message(reply);
  reply.request = kRequest + 2;
  reply.is_accepted = false;
  reply.reason = "there is no parameter of that name";
  write_message(reply);
  EXPECT_EQ(event_texts(), std::vector<std::string>{"get Bag.mass refused: there is no parameter of that name"});
}

TEST_F(Events, WithoutEitherAreARequest) {
  write_message(accepted(""));
  EXPECT_EQ(event_texts(), std::vector<std::string>{"request accepted"});
}

TEST_F(Events, WithoutARequestHaveTheirOwnText) {
  wire::ControlReply event_of_io = accepted("");
  event_of_io.request = 0;
  event_of_io.reason = "session.overrun: slip: at step 40";
  write_message(event_of_io);
  wire::ControllerLease lease;
  lease.header.step = kStep;
  lease.controller = "pid";
  lease.channel = "Input_Lift";
  lease.reason = "no value came";
  write_message(lease);
  EXPECT_EQ(event_texts(),
            (std::vector<std::string>{"session.overrun: slip: at step 40",
                                      "controller pid does not have channel Input_Lift: no value came"}));
}

// in their place among the other events, with the hysteresis of the live output
TEST_F(Events, ListOutputsThatGoOnOrOff) {
  write_session("Ball.center_of_mass.y");
  write_message(accepted(node::to_text(param_set())));
  const double heights[] = {0.5, 1.2, 0.95, 0.8, 0.95};
  for (StepIndex i = 0; i < 5; ++i) write_height(kStep - 3 + i, heights[i]);
  std::vector<std::pair<StepIndex, std::string>> seen;
  for (const RecordedEvent& event : events()) seen.emplace_back(event.step, event.text);
  EXPECT_EQ(seen, (std::vector<std::pair<StepIndex, std::string>>{{38, "output Lamp goes on"},
                                                                  {40, node::to_text(param_set()) + " accepted"},
                                                                  {40, "output Lamp goes off"}}));
}

TEST_F(Events, NameAnOutputWhoseVariableWasNotRecorded) {
  write_session("Ball.center_of_mass.x");
  write_height(kStep, 2);
  const std::vector<RecordedEvent> seen = events();
  ASSERT_EQ(seen.size(), 1u);
  EXPECT_EQ(seen[0].text, "output Lamp: its changes are not known, since Ball.center_of_mass.y was not recorded");
}

}  // namespace recorded_events_test
}  // namespace slew::session
