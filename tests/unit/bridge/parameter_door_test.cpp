// SPDX-License-Identifier: Apache-2.0
// Parameter requests from LCM: each is done once, repeated until it is answered, and answered again.
#include <gtest/gtest.h>

#include <slewring/parameter_t.hpp>

#include <limits>

#include "bridge/parameter_door.h"

namespace parameter_door_test {

using namespace slew;
using bridge::ParameterDoor;

constexpr std::int64_t kMs = 1'000'000;

struct Door {
  std::vector<wire::ControlRequest> sent;
  std::vector<ParameterDoor::Reply> replies;
  ParameterDoor door{[this](wire::ControlRequest request) {
                       if (request.request == 0) request.request = 1000 + sent.size();
                       sent.push_back(request);
                       return request.request;
                     },
                     [this](const ParameterDoor::Reply& reply) { replies.push_back(reply); }};

  void give(std::int64_t number, bool is_change, double value, double over, std::int64_t now_ns) {
    slewring::parameter_t message;
    message.request = number;
    message.is_change = is_change ? 1 : 0;
    message.path = "Bag.mass";
    message.value = value;
    message.over = over;
    std::vector<std::byte> bytes(static_cast<std::size_t>(message.getEncodedSize()));
    message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
    door.take(bytes, now_ns);
  }
  void answer(const wire::ControlRequest& request, bool is_accepted, double value, const std::string& reason) {
    wire::ControlReply reply;
    reply.header.step = 77;
    reply.request = request.request;
    reply.is_accepted = is_accepted;
    reply.value = value;
    reply.reason = reason;
    door.take(reply);
  }
};

TEST(BridgeParameters, AChangeIsSentAndAnswered) {
  Door door;
  door.give(5, true, 1500, 2.5, 0);
  ASSERT_EQ(door.sent.size(), 1u);
  EXPECT_EQ(door.sent[0].action, wire::ControlAction::set_parameter);
  EXPECT_EQ(door.sent[0].path, "Bag.mass");
  EXPECT_EQ(door.sent[0].value, 1500);
  EXPECT_EQ(door.sent[0].over_ns, 2'500'000'000);
  door.answer(door.sent[0], true, 0, "");
  ASSERT_EQ(door.replies.size(), 1u);
  EXPECT_TRUE(door.replies[0].is_accepted);
  EXPECT_EQ(door.replies[0].request.request, 5);
  EXPECT_EQ(door.replies[0].step, 77);
  EXPECT_EQ(door.replies[0].value, 1500);
}

TEST(BridgeParameters, ARepeatedRequestIsDoneOnceAndAnsweredAgain) {
  Door door;
  door.give(5, true, 1500, -1, 0);
  door.give(5, true, 1500, -1, kMs);
  EXPECT_EQ(door.sent.size(), 1u);
  EXPECT_EQ(door.sent[0].over_ns, -1);
  door.answer(door.sent[0], false, 0, "no parameter 'Bag.mass'");
  door.give(5, true, 1500, -1, 2 * kMs);
  EXPECT_EQ(door.sent.size(), 1u);
  ASSERT_EQ(door.replies.size(), 2u);
  EXPECT_FALSE(door.replies[1].is_accepted);
  EXPECT_EQ(door.replies[1].reason, "no parameter 'Bag.mass'");
}

TEST(BridgeParameters, ARequestIsRepeatedWithItsNumberAndGivenUp) {
  Door door;
  door.give(5, false, 0, -1, 0);
  for (std::int64_t ms = 0; ms <= 3300; ms += 10) door.door.poll(ms * kMs);
  EXPECT_EQ(door.sent.size(), 13u);  // at 0, 250, .. 3000 ms
  for (const wire::ControlRequest& request : door.sent) {
    EXPECT_EQ(request.request, door.sent[0].request);
    EXPECT_EQ(request.action, wire::ControlAction::get_parameter);
  }
  ASSERT_EQ(door.replies.size(), 1u);
  EXPECT_FALSE(door.replies[0].is_accepted);
  EXPECT_NE(door.replies[0].reason.find("has not answered"), std::string::npos);
}

TEST(BridgeParameters, RepliesToOthersAreIgnored) {
  Door door;
  door.give(5, false, 0, -1, 0);
  wire::ControlRequest other = door.sent[0];
  other.request += 1;
  door.answer(other, true, 3, "");
  EXPECT_TRUE(door.replies.empty());
}

TEST(BridgeParameters, ValuesThatAreNotFiniteAndDamagedBytesReachNoSession) {
  Door door;
  door.give(5, true, std::numeric_limits<double>::quiet_NaN(), -1, 0);
  door.give(6, true, 1, std::numeric_limits<double>::infinity(), 0);
  door.give(7, true, 1, 1e7, 0);
  ASSERT_EQ(door.replies.size(), 3u);
  for (const auto& reply : door.replies) EXPECT_FALSE(reply.is_accepted);
  door.door.take({}, 0);
  EXPECT_EQ(door.door.refused(), 4u);
  EXPECT_TRUE(door.sent.empty());
}

TEST(BridgeParameters, RequestsBeyondThoseThatWaitAreRefused) {
  Door door;
  for (int i = 0; i < 65; ++i) door.give(i, false, 0, -1, 0);
  EXPECT_EQ(door.sent.size(), 64u);
  ASSERT_EQ(door.replies.size(), 1u);
  EXPECT_FALSE(door.replies[0].is_accepted);
  door.answer(door.sent[0], true, 1, "");
  door.give(64, false, 0, -1, 0);
  EXPECT_EQ(door.sent.size(), 65u);
}

}  // namespace parameter_door_test
