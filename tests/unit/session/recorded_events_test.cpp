// Output of `info --events` for requests, answers and leases in a recording.
#include "session/recorded_events.h"

#include <gtest/gtest.h>

#include <map>
#include <memory>
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
wire::ControlReply accepted(const std::string& asked) {
  wire::ControlReply reply;
  reply.header.step = kStep;
  reply.request = kRequest;
  reply.is_accepted = true;
  reply.asked = asked;
  return reply;
}

class Events : public ::testing::Test {
 protected:
  Events() {
    recording::SessionIdentity identity;
    identity.communication_step = milliseconds(1);
    EXPECT_EQ(recording::Writer::create(path_, identity, {}, writer_).text, "");
    for (const Topic topic : {Topic::control_request, Topic::control_reply, Topic::controller_lease}) {
      EXPECT_EQ(
          writer_->add_channel({std::string(node::to_text(topic)), "slewring::Any", "", {}}, channels_[topic]).text,
          "");
    }
  }

  template <typename Message>
  void say(const Message& message) {
    std::vector<std::byte> bytes;
    ASSERT_TRUE(transport::encode(message, bytes));
    ASSERT_EQ(writer_->write(channels_[transport::kTopicOf<Message>], {0, kStep, 0, 0}, bytes).text, "");
  }

  std::vector<std::string> told() {
    EXPECT_EQ(writer_->close({}).text, "");
    std::unique_ptr<recording::Reader> reader;
    EXPECT_EQ(recording::Reader::open(path_, reader).text, "");
    std::vector<std::string> texts;
    for (const RecordedEvent& event : recorded_events(*reader)) {
      EXPECT_EQ(event.step, kStep);
      texts.push_back(event.text);
    }
    return texts;
  }

 private:
  testing::TemporaryFolder folder_{"events"};
  std::filesystem::path path_ = folder_.path() / "session.mcap";
  std::unique_ptr<recording::Writer> writer_;
  std::map<Topic, recording::ChannelId> channels_;
};

TEST_F(Events, SayWhatWasAskedWhereTheRequestItselfWasNotRecorded) {
  say(accepted(node::to_text(param_set())));
  EXPECT_EQ(told(), std::vector{node::to_text(param_set()) + " accepted"});
}

TEST_F(Events, OfAnEarlierRecordingSayItByTheRequest) {
  say(param_set());
  say(accepted(""));
  EXPECT_EQ(told(), std::vector{node::to_text(param_set()) + " accepted"});
}

TEST_F(Events, TellAnAnswerThatWasSaidAgainOnce) {
  say(accepted(node::to_text(param_set())));
  say(accepted(node::to_text(param_set())));
  EXPECT_EQ(told().size(), 1u);
}

TEST_F(Events, WithoutEitherAreARequest) {
  say(accepted(""));
  EXPECT_EQ(told(), std::vector<std::string>{"request accepted"});
}

TEST_F(Events, NobodyAskedForAreToldInTheirOwnWords) {
  wire::ControlReply told_by_io = accepted("");
  told_by_io.request = 0;
  told_by_io.reason = "session.overrun: slip: at step 40";
  say(told_by_io);
  wire::ControllerLease lease;
  lease.header.step = kStep;
  lease.controller = "pid";
  lease.channel = "Input_Lift";
  lease.reason = "no value came";
  say(lease);
  EXPECT_EQ(told(), (std::vector<std::string>{"session.overrun: slip: at step 40",
                                              "controller pid does not have channel Input_Lift: no value came"}));
}

}  // namespace recorded_events_test
}  // namespace slew::session
