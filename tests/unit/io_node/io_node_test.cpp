// The owner of a session, with the physics nodes and the clock played by the test.
#include "io_node/io_node.h"

#include <gtest/gtest.h>

#include "tests/support/played_session.h"

namespace slew::io {
namespace {

using testing::kMs;
using testing::PlayedSession;
using wire::NodeState;
using wire::Phase;
using wire::Role;
using wire::Topic;

class Io : public ::testing::Test {
 protected:
  static IoConfig config() {
    IoConfig config;
    config.session_name = "s";
    config.scene_name = "still";
    config.required_roles = bit(Role::io) | bit(Role::mechanics) | bit(Role::hydraulics);
    config.name_check = {};
    return config;
  }
  void poll(std::int64_t after_ns = 0) { node.poll(now_ns += after_ns); }

  // the session runs: tick 0 is out
  void get_running() {
    poll();
    const auto sessions = played.said<wire::SessionDescription>(Topic::session);
    ASSERT_FALSE(sessions.empty());
    played.session.header = sessions.back().header;
    for (const Role role : {Role::mechanics, Role::hydraulics}) {
      played.say_heard(role, NodeState::joining, node.member().header(Phase::join, kJoinStep), {Topic::tick});
    }
    poll(kMs);
    played.say_status(Role::mechanics, NodeState::ready, 0);
    played.say_status(Role::hydraulics, NodeState::ready, 0);
    say_samples(0);
    poll(kMs);
    poll();
    ASSERT_EQ(node.next_step(), 1);
  }
  void say_samples(StepIndex step) {
    played.say_mechanism(step, Phase::running, node.member().epoch());
    played.say_actuators(step, Phase::running, node.member().epoch());
  }
  // steps in time: each tick is answered at once
  void run_to(StepIndex step) {
    while (node.next_step() < step) {
      say_samples(node.next_step());
      poll(kMs);
    }
  }
  wire::ControlReply request(wire::ControlAction action, double value = 0) {
    wire::ControlRequest request;
    request.session = "s";
    request.request = ++requests_;
    request.action = action;
    request.value = value;
    played.say(Topic::control_request, request);
    poll();
    const auto replies = played.said<wire::ControlReply>(Topic::control_reply);
    EXPECT_EQ(replies.size(), 1u);
    return replies.empty() ? wire::ControlReply{} : replies.back();
  }

  PlayedSession played{0};
  IoNode node{played.carrier(), config()};
  std::int64_t now_ns = 1000 * kMs;
  std::uint64_t requests_ = 0;
};

TEST_F(Io, DoesNotBelieveASampleThatCannotExist) {
  get_running();
  run_to(5);
  const std::uint64_t refused = node.member().refusals().too_far_ahead;
  say_samples(node.next_step() + 1);
  say_samples(StepIndex{1} << 52);
  poll(kMs);
  EXPECT_EQ(node.next_step(), 5) << "a tick went out without the samples it waits for";
  EXPECT_EQ(node.member().refusals().too_far_ahead, refused + 4);
  run_to(7);
}

TEST_F(Io, DoesNotTakeTheSamplesOfAnotherRole) {
  get_running();
  run_to(5);
  wire::MechanismMessage sample;
  sample.header = played.header(Role::hydraulics, 5);
  played.say(Topic::mechanism, sample);
  sample.header = played.header(Role::controller, 5);
  played.say(Topic::mechanism, sample);
  played.say_actuators(5);
  poll(kMs);
  EXPECT_EQ(node.next_step(), 5);
  EXPECT_EQ(node.member().refusals().unexpected_writer, 2u);
}

}  // namespace
}  // namespace slew::io
