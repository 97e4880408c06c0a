// SPDX-License-Identifier: Apache-2.0
// Inputs that clients move: one holder, neutral after silence, and given back when a client leaves.
#include "gateway/client_inputs.h"

#include <gtest/gtest.h>

namespace client_inputs_test {

using namespace slew;
using namespace slew::gateway;
using Acquire = observer::InputLeases::Acquire;

constexpr std::int64_t kMs = 1'000'000;

struct Seat {
  std::vector<wire::ControllerInput> sent;
  std::vector<std::string> silent;
  ClientInputs inputs{{{"Lift", false, false}, {"Jib", false, true}},
                      "window",
                      [this](const wire::ControllerInput& input) { sent.push_back(input); }};

  // The session's answer to the last message.
  void answer(bool is_granted, const std::string& holder, const std::string& reason = "") {
    wire::ControllerLease lease;
    lease.controller = sent.back().controller;
    lease.channel = sent.back().channel;
    lease.is_granted = is_granted;
    lease.holder = holder;
    lease.reason = reason;
    lease.answers = sent.back().sequence;
    inputs.take(lease);
  }
  void hold(ClientId client) {
    EXPECT_EQ(inputs.publish(client, "Lift", 0.1, 0, 0), "");
    answer(true, inputs.controller_of(client));
  }
  void poll(std::int64_t now_ns) {
    inputs.poll(now_ns, [this](ClientId, const std::string& input) { silent.push_back(input); });
  }
};

TEST(ClientInputs, TheFirstValueRequestsTheLeaseAndLaterOnesGoThrough) {
  Seat seat;
  seat.hold(1);
  ASSERT_EQ(seat.sent.size(), 1u);
  EXPECT_EQ(seat.sent[0].action, wire::ControllerAction::acquire);
  EXPECT_EQ(seat.sent[0].controller, "window:1");
  EXPECT_EQ(seat.inputs.publish(1, "Lift", 0.4, 7, kMs), "");
  EXPECT_EQ(seat.sent[1].action, wire::ControllerAction::write);
  EXPECT_EQ(seat.sent[1].value, 0.4);
}

TEST(ClientInputs, AnInputWhoseClientIsSilentGoesToNeutralWithin200Ms) {
  Seat seat;
  seat.hold(1);
  static_cast<void>(seat.inputs.publish(1, "Lift", 0.4, 7, 10 * kMs));
  seat.poll(100 * kMs);
  EXPECT_EQ(seat.sent.size(), 2u);
  seat.poll(165 * kMs);
  ASSERT_EQ(seat.sent.size(), 3u);
  EXPECT_EQ(seat.sent[2].action, wire::ControllerAction::write);
  EXPECT_EQ(seat.sent[2].value, 0);
  EXPECT_EQ(seat.silent, std::vector<std::string>{"Lift"});
  // once: after it the silence is the session's matter
  seat.poll(1000 * kMs);
  EXPECT_EQ(seat.sent.size(), 3u);
}

TEST(ClientInputs, AClientThatLeavesGivesItsInputsBack) {
  Seat seat;
  seat.hold(1);
  seat.inputs.leave(1);
  ASSERT_EQ(seat.sent.size(), 2u);
  EXPECT_EQ(seat.sent[1].action, wire::ControllerAction::release);
  EXPECT_EQ(seat.sent[1].channel, "Lift");
}

TEST(ClientInputs, AClientThatLeavesBeforeTheAnswerGivesTheInputBackToo) {
  Seat seat;
  static_cast<void>(seat.inputs.publish(1, "Lift", 0.1, 0, 0));
  seat.inputs.leave(1);
  EXPECT_EQ(seat.sent.back().action, wire::ControllerAction::release);
}

TEST(ClientInputs, AnotherClientIsRefusedWithTheReasonOfTheSession) {
  Seat seat;
  seat.hold(1);
  std::string problem = "none yet";
  EXPECT_EQ(seat.inputs.lease(
                2, "Lift", Acquire::free, [&](const std::string& text) { problem = text; }, 0),
            "");
  seat.answer(false, "window:1", "channel Lift is held by 'window:1'");
  EXPECT_EQ(problem, "channel Lift is held by 'window:1'");
  static_cast<void>(seat.inputs.publish(2, "Lift", 1, 0, 3000 * kMs));
  EXPECT_NE(seat.sent.back().action, wire::ControllerAction::write);
}

TEST(ClientInputs, ATakeOverIsRequestedAsOne) {
  Seat seat;
  EXPECT_EQ(seat.inputs.lease(
                1, "Lift", Acquire::take_over, [](const std::string&) {}, 0),
            "");
  EXPECT_EQ(seat.sent.back().value, wire::kTakeOver);
}

TEST(ClientInputs, ARequestWithoutAnAnswerIsGivenUp) {
  Seat seat;
  std::string problem;
  EXPECT_EQ(seat.inputs.lease(
                1, "Lift", Acquire::free, [&](const std::string& text) { problem = text; }, 0),
            "");
  seat.poll(2999 * kMs);
  EXPECT_EQ(problem, "");
  seat.poll(3001 * kMs);
  EXPECT_NE(problem.find("has not answered"), std::string::npos);
}

TEST(ClientInputs, WhatCannotMoveAnInputIsRefused) {
  Seat seat;
  EXPECT_NE(seat.inputs.publish(1, "Slow", 0.1, 0, 0).find("no input 'Slow'"), std::string::npos);
  EXPECT_NE(seat.inputs.publish(1, "Jib", 0.1, 0, 0).find("lockstep"), std::string::npos);
  EXPECT_NE(seat.inputs.publish(1, "Lift", std::numeric_limits<double>::quiet_NaN(), 0, 0).find("not finite"),
            std::string::npos);
  EXPECT_NE(seat.inputs.release(1, "Lift"), "");
  EXPECT_TRUE(seat.sent.empty());
}

TEST(ClientInputs, AfterAResetTheLeaseIsRequestedAgain) {
  Seat seat;
  seat.inputs.take_epoch(0);
  seat.hold(1);
  seat.inputs.take_epoch(1);
  static_cast<void>(seat.inputs.publish(1, "Lift", 0.4, 7, 1000 * kMs));
  EXPECT_EQ(seat.sent.back().action, wire::ControllerAction::acquire);
}

}  // namespace client_inputs_test
