// SPDX-License-Identifier: Apache-2.0
// Inputs and requests, decoded from bytes of the generated encoders, and damaged ones.
#include <gtest/gtest.h>

#include <cstring>
#include <slewring/parameter_t.hpp>

#include "lcm_log/messages.h"
#include "tests/unit/lcm_log/input_bytes.h"

namespace messages_test {

using namespace slew::lcm_log;

TEST(LcmMessages, AnInputOfTheGeneratedEncoderIsReadBack) {
  slewring::input_t sent = lift(41, -0.25);
  sent.based_on_step = 1234;
  Input input;
  ASSERT_EQ(decode(bytes_of(sent), input), Decoded::ok);
  EXPECT_EQ(input.controller, "joystick");
  EXPECT_EQ(input.sender, 7);
  EXPECT_EQ(input.sequence, 41);
  EXPECT_EQ(input.channel, "Input_Lift");
  EXPECT_EQ(input.value, -0.25);
  EXPECT_EQ(input.based_on_step, 1234);
  std::string again;
  encode(input, again);
  const std::vector<std::byte> bytes = bytes_of(sent);
  ASSERT_EQ(again.size(), bytes.size());
  EXPECT_EQ(std::memcmp(again.data(), bytes.data(), bytes.size()), 0);
}

TEST(LcmMessages, AParameterRequestOfTheGeneratedEncoderIsReadBack) {
  slewring::parameter_t sent;
  sent.request = 5;
  sent.is_change = 1;
  sent.path = "Bag.mass";
  sent.value = 1500;
  sent.over = -1;
  std::vector<std::byte> bytes(static_cast<std::size_t>(sent.getEncodedSize()));
  sent.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  ParameterRequest request;
  ASSERT_EQ(decode(bytes, request), Decoded::ok);
  EXPECT_EQ(request.request, 5);
  EXPECT_TRUE(request.is_change);
  EXPECT_EQ(request.path, "Bag.mass");
  EXPECT_EQ(request.value, 1500);
  bytes[16] = std::byte{2};  // a truth value that is none
  EXPECT_EQ(decode(bytes, request), Decoded::damaged);
}

TEST(LcmMessages, EveryCutAndEveryLongerMessageIsRefused) {
  std::vector<std::byte> bytes = bytes_of(lift(1, 1));
  Input input;
  for (std::size_t size = 0; size < bytes.size(); ++size)
    EXPECT_NE(decode(std::span(bytes).first(size), input), Decoded::ok) << size;
  bytes.push_back(std::byte{0});
  EXPECT_EQ(decode(bytes, input), Decoded::damaged);
}

// the generated decoder assigns length - 1 characters without a look at the length
TEST(LcmMessages, LengthsOfStringsAreNotTrusted) {
  const std::vector<std::byte> good = bytes_of(lift(1, 1));
  Input input;
  for (const std::uint32_t length : {0u, 1u, 8u, 10u, 64u, 65u, 0x7fffffffu, 0x80000000u, 0xffffffffu}) {
    std::vector<std::byte> bytes = good;
    for (std::size_t i = 0; i < 4; ++i) bytes[8 + i] = static_cast<std::byte>(length >> (24 - 8 * i));
    EXPECT_EQ(decode(bytes, input), Decoded::damaged) << length;
  }
}

TEST(LcmMessages, ANegativeSequenceAndAStepBelowMinusOneAreDamage) {
  Input input;
  EXPECT_EQ(decode(bytes_of(lift(-1, 0)), input), Decoded::damaged);
  slewring::input_t message = lift(1, 0);
  message.based_on_step = -2;
  EXPECT_EQ(decode(bytes_of(message), input), Decoded::damaged);
}

TEST(LcmMessages, AnotherTypeIsNoDamage) {
  std::vector<std::byte> bytes = bytes_of(lift(1, 1));
  bytes[3] ^= std::byte{1};
  Input input;
  EXPECT_EQ(decode(bytes, input), Decoded::other_type);
}

}  // namespace messages_test
