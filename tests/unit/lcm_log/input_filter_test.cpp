// SPDX-License-Identifier: Apache-2.0
// What may reach the session: every cause of a refusal, gaps of the sequence, senders that take turns.
#include <gtest/gtest.h>

#include <limits>

#include "lcm_log/input_filter.h"
#include "tests/unit/lcm_log/input_bytes.h"

namespace input_filter_test {

using namespace slew::lcm_log;

constexpr std::int64_t kMs = 1'000'000;

InputFilter filter() {
  return InputFilter({{"Input_Lift", false, false}, {"Input_Jib", false, true}}, {"joystick", "pid"});
}

TEST(InputFilter, NumbersInOrderAreAccepted) {
  InputFilter inputs = filter();
  for (std::int64_t i = 0; i < 5; ++i) {
    const auto input = inputs.take(bytes_of(lift(i, 0.1)), i * kMs, 100);
    ASSERT_TRUE(input.has_value());
    EXPECT_EQ(input->value, 0.1);
  }
  EXPECT_EQ(inputs.counts(), InputCounts());
  EXPECT_TRUE(inputs.take_notices().empty());
}

TEST(InputFilter, MissingNumbersAreCountedAndOldOnesRefused) {
  InputFilter inputs = filter();
  EXPECT_TRUE(inputs.take(bytes_of(lift(10, 0)), 0, 0));
  EXPECT_TRUE(inputs.take(bytes_of(lift(14, 0)), kMs, 0));
  EXPECT_TRUE(inputs.take(bytes_of(lift(16, 0)), 2 * kMs, 0));
  EXPECT_EQ(inputs.counts().gaps, 2u);
  EXPECT_EQ(inputs.counts().lost, 4u);
  EXPECT_FALSE(inputs.take(bytes_of(lift(16, 0)), 3 * kMs, 0));
  EXPECT_FALSE(inputs.take(bytes_of(lift(11, 0)), 3 * kMs, 0));
  EXPECT_EQ(inputs.counts().of(Cause::old_sequence), 2u);
  // a new numbering is a gap without lost messages
  EXPECT_TRUE(inputs.take(bytes_of(lift(std::numeric_limits<std::int64_t>::max(), 0)), 4 * kMs, 0));
  EXPECT_EQ(inputs.counts().gaps, 3u);
  EXPECT_EQ(inputs.counts().lost, 4u);
}

TEST(InputFilter, EveryCauseIsCountedOnceAMessageAndExplainedOnce) {
  const auto refused = [](const slewring::input_t& message, Cause cause, std::string_view notice) {
    InputFilter inputs = filter();
    slewring::input_t first = message;
    EXPECT_FALSE(inputs.take(bytes_of(first), 0, 100)) << to_text(cause);
    first.sequence += 1;
    EXPECT_FALSE(inputs.take(bytes_of(first), kMs, 100)) << to_text(cause);
    InputCounts expected;
    expected.of(cause) = 2;
    EXPECT_EQ(inputs.counts(), expected) << to_text(cause);
    const auto notices = inputs.take_notices();
    ASSERT_EQ(notices.size(), 1u) << to_text(cause);
    EXPECT_NE(notices.front().find(notice), std::string::npos) << notices.front();
    EXPECT_NE(notices.front().find("not applied"), std::string::npos);
  };
  refused(lift(1, std::numeric_limits<double>::quiet_NaN()), Cause::not_finite, "not finite");
  refused(lift(1, -std::numeric_limits<double>::infinity()), Cause::not_finite, "not finite");
  slewring::input_t message = lift(1, 0);
  message.channel = "Input_Lif";
  refused(message, Cause::no_channel, "the scene has no input 'Input_Lif'");
  message.channel = "Input_Jib";
  refused(message, Cause::lockstep_channel, "--set Input_Jib.controller=sampled");
  message = lift(1, 0);
  message.controller = "stranger";
  refused(message, Cause::other_controller, "--controller stranger");
  message = lift(1, 0);
  message.based_on_step = 101;
  refused(message, Cause::future_step, "the session is at 100");
  message = lift(1, 0);
  message.channel = std::string(64, 'x');
  refused(message, Cause::damaged, "damaged");
}

TEST(InputFilter, ASecondSenderOfANameWaitsUntilTheFirstIsSilent) {
  InputFilter inputs = filter();
  slewring::input_t second = lift(0, 1);
  second.sender = 8;
  EXPECT_TRUE(inputs.take(bytes_of(lift(500, 0)), 0, 0));
  EXPECT_FALSE(inputs.take(bytes_of(second), 500 * kMs, 0));
  EXPECT_TRUE(inputs.take(bytes_of(lift(501, 0)), 900 * kMs, 0));
  EXPECT_FALSE(inputs.take(bytes_of(second), 1800 * kMs, 0));
  EXPECT_EQ(inputs.counts().of(Cause::other_sender), 2u);
  EXPECT_TRUE(inputs.take(bytes_of(second), 1901 * kMs, 0));
  EXPECT_EQ(inputs.counts().lost, 0u);
  // the first one is the stranger now
  EXPECT_FALSE(inputs.take(bytes_of(lift(502, 0)), 1902 * kMs, 0));
}

TEST(InputFilter, ARestartedSenderOfOneNumberIsAcceptedAfterTheSilence) {
  InputFilter inputs = filter();
  EXPECT_TRUE(inputs.take(bytes_of(lift(500, 0)), 0, 0));
  EXPECT_FALSE(inputs.take(bytes_of(lift(1, 0)), 1000 * kMs, 0));
  EXPECT_TRUE(inputs.take(bytes_of(lift(2, 0)), 1001 * kMs, 0));
  EXPECT_TRUE(inputs.take(bytes_of(lift(3, 0)), 1002 * kMs, 0));
  EXPECT_EQ(inputs.counts().lost, 0u);
  // the same one after a silence has lost what is missing
  EXPECT_TRUE(inputs.take(bytes_of(lift(10, 0)), 3000 * kMs, 0));
  EXPECT_EQ(inputs.counts().lost, 6u);
}

}  // namespace input_filter_test
