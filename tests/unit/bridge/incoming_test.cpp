// SPDX-License-Identifier: Apache-2.0
// Inputs on their way into a session: leases are requested, values go only through a held one, losses are reported.
#include <gtest/gtest.h>

#include <cmath>

#include "bridge/incoming.h"
#include "tests/unit/lcm_log/input_bytes.h"

namespace incoming_test {

using namespace slew;
using lcm_log::bytes_of;
using lcm_log::Cause;
using lcm_log::lift;
using wire::ControllerAction;

constexpr std::int64_t kMs = 1'000'000;

// A bridge with its session's side.
struct Pair {
  std::vector<wire::ControllerInput> sent;
  bridge::Incoming incoming{{{"Input_Lift", false, false}}, {"joystick"}, [this](const wire::ControllerInput& input) {
                              sent.push_back(input);
                            }};

  void give(std::int64_t sequence, double value, std::int64_t now_ns) {
    incoming.take(bytes_of(lift(sequence, value)), now_ns, 100);
  }
  // io_node's answer to the last message
  void answer(bool is_granted, const std::string& reason, std::uint32_t epoch = 0) {
    wire::ControllerLease lease;
    lease.header.epoch = epoch;
    lease.controller = sent.back().controller;
    lease.channel = sent.back().channel;
    lease.is_granted = is_granted;
    lease.holder = is_granted ? lease.controller : "another";
    lease.reason = reason;
    lease.answers = sent.back().sequence;
    incoming.take(lease);
  }
  void notify(bool is_granted, const std::string& reason) {
    wire::ControllerLease lease;
    lease.controller = "lcm:joystick";
    lease.channel = "Input_Lift";
    lease.is_granted = is_granted;
    lease.holder = is_granted ? lease.controller : "";
    lease.reason = reason;
    incoming.take(lease);
  }
};

TEST(BridgeIncoming, TheFirstInputAcquiresAndLaterOnesAreWritten) {
  Pair pair;
  pair.give(1, 0.5, 0);
  ASSERT_EQ(pair.sent.size(), 1u);
  EXPECT_EQ(pair.sent[0].action, ControllerAction::acquire);
  EXPECT_EQ(pair.sent[0].controller, "lcm:joystick");
  EXPECT_EQ(pair.sent[0].channel, "Input_Lift");
  EXPECT_EQ(pair.sent[0].value, 0);  // no take-over
  pair.give(2, 0.5, 10 * kMs);
  EXPECT_EQ(pair.sent.size(), 1u);
  pair.answer(true, "");
  EXPECT_EQ(pair.sent.size(), 1u);  // an old value is not written
  pair.give(3, 0.25, 20 * kMs);
  ASSERT_EQ(pair.sent.size(), 2u);
  EXPECT_EQ(pair.sent[1].action, ControllerAction::write);
  EXPECT_EQ(pair.sent[1].value, 0.25);
  EXPECT_GT(pair.sent[1].sequence, pair.sent[0].sequence);
  EXPECT_EQ(pair.incoming.counts().applied, 1u);
  EXPECT_EQ(pair.incoming.counts().of(Cause::no_lease), 2u);
  EXPECT_EQ(pair.incoming.take_notices(), std::vector<std::string>{"'lcm:joystick' holds channel Input_Lift"});
}

TEST(BridgeIncoming, ARequestWithoutAnAnswerIsRepeated) {
  Pair pair;
  for (int i = 0; i < 100; ++i) pair.give(i, 0, i * 10 * kMs);
  EXPECT_EQ(pair.sent.size(), 5u);  // 0, 200, 400, 600, 800 ms
  for (const wire::ControllerInput& message : pair.sent) EXPECT_EQ(message.action, ControllerAction::acquire);
  pair.answer(true, "");
  pair.give(100, 1, 1000 * kMs);
  EXPECT_EQ(pair.sent.back().action, ControllerAction::write);
}

TEST(BridgeIncoming, ARefusalIsReportedOnceAndTriedAgainAfterASecond) {
  Pair pair;
  pair.give(0, 0, 0);
  pair.answer(false, "channel Input_Lift is held by 'pid'");
  for (int i = 1; i < 100; ++i) pair.give(i, 0, i * 10 * kMs);
  EXPECT_EQ(pair.sent.size(), 1u);
  pair.give(100, 0, 1000 * kMs);
  EXPECT_EQ(pair.sent.size(), 2u);
  pair.answer(false, "channel Input_Lift is held by 'pid'");
  EXPECT_EQ(pair.incoming.take_notices(), std::vector<std::string>{"channel Input_Lift is held by 'pid'"});
}

TEST(BridgeIncoming, ALostLeaseIsReportedAndNothingIsWrittenWithoutOne) {
  Pair pair;
  pair.give(0, 0, 0);
  pair.answer(true, "");
  static_cast<void>(pair.incoming.take_notices());
  pair.notify(true, "no value of 'lcm:joystick' came for 500 ms: channel Input_Lift goes to neutral");
  pair.notify(false, "no value came for 5000 ms: channel Input_Lift is free");
  EXPECT_EQ(pair.incoming.take_notices().size(), 2u);
  pair.give(1, 0.5, 6000 * kMs);
  EXPECT_EQ(pair.sent.back().action, ControllerAction::acquire);
  pair.answer(true, "");
  pair.give(2, 0.5, 6010 * kMs);
  EXPECT_EQ(pair.sent.back().action, ControllerAction::write);
}

TEST(BridgeIncoming, AResetFreesTheChannels) {
  Pair pair;
  pair.incoming.take_epoch(0);
  pair.give(0, 0, 0);
  pair.answer(true, "");
  pair.incoming.take_epoch(1);
  pair.give(1, 0.5, 10 * kMs);
  EXPECT_EQ(pair.sent.back().action, ControllerAction::acquire);
}

TEST(BridgeIncoming, AnAnswerInALaterEpochThanTheFirstIsTaken) {
  Pair pair;
  pair.give(0, 0, 0);
  pair.answer(true, "", 3);
  pair.give(1, 0.5, 10 * kMs);
  EXPECT_EQ(pair.sent.back().action, ControllerAction::write);
}

TEST(BridgeIncoming, AnswersToAnotherProcessAreIgnored) {
  Pair pair;
  pair.give(0, 0, 0);
  wire::ControllerLease lease;
  lease.controller = "lcm:joystick";
  lease.channel = "Input_Lift";
  lease.is_granted = true;
  lease.holder = lease.controller;
  lease.answers = pair.sent.back().sequence - 1;
  pair.incoming.take(lease);
  pair.give(1, 0.5, 10 * kMs);
  EXPECT_EQ(pair.incoming.counts().applied, 0u);
}

TEST(BridgeIncoming, HeldChannelsAreGivenBack) {
  Pair pair;
  pair.give(0, 0, 0);
  pair.incoming.release();
  EXPECT_EQ(pair.sent.size(), 1u);
  pair.give(1, 0, 500 * kMs);
  pair.answer(true, "");
  pair.incoming.release();
  EXPECT_EQ(pair.sent.back().action, ControllerAction::release);
}

TEST(BridgeIncoming, ValuesThatAreNotFiniteReachNoSession) {
  Pair pair;
  pair.give(0, 0, 0);
  pair.answer(true, "");
  pair.give(1, std::nan(""), 10 * kMs);
  EXPECT_EQ(pair.sent.size(), 1u);
  EXPECT_EQ(pair.incoming.counts().of(Cause::not_finite), 1u);
}

}  // namespace incoming_test
