// SPDX-License-Identifier: Apache-2.0
#include "transport/cdr/codec.h"

#include <gtest/gtest.h>

#include <cstring>
#include <random>

#include "core/allocation_guard.h"
#include "tests/support/nightly.h"
#include "tests/support/random_message.h"

namespace slew::transport {
namespace codec_test {

using testing::random_message;

template <typename M>
class EveryMessage : public ::testing::Test {};

using Messages =
    ::testing::Types<wire::SessionDescription, wire::NodeStatus, wire::Tick, wire::MechanismMessage,
                     wire::ActuatorMessage, wire::FlexibleMessage, wire::ElasticMessage, wire::VariableDirectory,
                     wire::VariableBlock, wire::ControllerInput, wire::ControllerLease, wire::ControlRequest,
                     wire::ControlReply, wire::Health, wire::ResendRequest, wire::StatePart>;
TYPED_TEST_SUITE(EveryMessage, Messages);

TYPED_TEST(EveryMessage, ComesBackAsItWasSent) {
  std::mt19937_64 random(1);
  ByteBuffer buffer;
  TypeParam received;
  for (int i = 0; i < 200; ++i) {
    const TypeParam sent = random_message<TypeParam>(random, static_cast<std::size_t>(i));
    ASSERT_TRUE(encode(sent, buffer));
    EXPECT_EQ(buffer.size() % 4, 0u);
    ASSERT_TRUE(decode(buffer, received));
    EXPECT_TRUE(received == sent);
  }
}

TYPED_TEST(EveryMessage, CutAnywhereIsRefused) {
  std::mt19937_64 random(2);
  ByteBuffer buffer;
  TypeParam message = random_message<TypeParam>(random, 7);
  if constexpr (std::is_same_v<TypeParam, wire::ActuatorMessage>) message.sample.K_cross.clear();
  ASSERT_TRUE(encode(message, buffer));
  const std::size_t padding = static_cast<std::size_t>(buffer[3]);
  TypeParam received;
  // fields that earlier versions ended without, and the gap in front of them, have a test of their own
  constexpr bool kHasAppended = std::is_same_v<TypeParam, wire::ControllerLease> ||
                                std::is_same_v<TypeParam, wire::ControlReply> ||
                                std::is_same_v<TypeParam, wire::ActuatorMessage>;
  const std::size_t appended = kHasAppended ? 16 : 0;
  for (std::size_t size = 0; size < buffer.size() - padding - appended; ++size) {
    // a copy of exactly this size, so that a sanitizer sees any read beyond it
    const ByteBuffer cut(buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_FALSE(decode(cut, received)) << size;
  }
}

// Fields that earlier versions ended without are read as empty, and no other cut is taken for such an end.
template <typename M, typename Appended>
void expect_may_be_missing(M sent, Appended appended, std::size_t whole_before) {
  ByteBuffer buffer;
  ASSERT_TRUE(encode(sent, buffer));
  const std::size_t whole = buffer.size() - static_cast<std::size_t>(buffer[3]);
  M received;
  M expected = sent;
  appended(expected) = {};
  for (std::size_t size = 0; size < whole; ++size) {
    appended(received) = appended(sent);
    const bool was_whole = size >= whole_before && size < whole_before + 4;  // padded to 4 bytes
    ASSERT_EQ(decode(std::span(buffer).first(size), received), was_whole) << size;
    EXPECT_TRUE(!was_whole || received == expected);
  }
}

TEST(OfARecordingOfVersion3, ALeaseLacksTheNumberThatItAnswers) {
  std::mt19937_64 random(2);
  wire::ControllerLease lease = random_message<wire::ControllerLease>(random, 0);
  lease.reason = "abc";
  lease.answers = 7;
  // encapsulation, header, two empty texts, a flag, an empty text, "abc"
  expect_may_be_missing(
      lease, [](wire::ControllerLease & m) -> auto& { return m.answers; }, 4 + 40 + 2 * 8 + 8 + 8);
}

TEST(OfARecordingOfVersion3, AReplyLacksTheTextOfTheRequest) {
  std::mt19937_64 random(2);
  wire::ControlReply reply = random_message<wire::ControlReply>(random, 0);
  reply.reason = "abc";
  reply.asked = "stop";
  // encapsulation, header, request, a flag, value, "abc"
  expect_may_be_missing(
      reply, [](wire::ControlReply & m) -> auto& { return m.asked; }, 4 + 40 + 8 + 8 + 8 + 8);
}

TEST(OfARecordingOfVersion6, ASampleLacksTheStiffnessBetweenPorts) {
  wire::ActuatorMessage message;
  message.sample.K_cross = {0, -3, -3, 0};
  // encapsulation, header, state, the lengths of 14 empty lists, flags
  expect_may_be_missing(
      message, [](wire::ActuatorMessage & m) -> auto& { return m.sample.K_cross; }, 4 + 40 + 44 + 14 * 4 + 4);
}

TEST(OfARecordingOfVersion4, ADescriptionGivesANodeUpAfter2Seconds) {
  wire::SessionDescription session;
  session.protocol = 4;
  session.rejoin_ns = 7;
  session.give_up_ns = 9'000'000'000;
  ByteBuffer before, now;
  ASSERT_TRUE(encode(session, before));
  session.protocol = 5;
  ASSERT_TRUE(encode(session, now));
  EXPECT_GT(now.size(), before.size());
  wire::SessionDescription received;
  ASSERT_TRUE(decode(before, received));
  EXPECT_EQ(received.rejoin_ns, 7);
  EXPECT_EQ(received.give_up_ns, 2'000'000'000);
  ASSERT_TRUE(decode(now, received));
  EXPECT_EQ(received.give_up_ns, 9'000'000'000);
  for (const std::int64_t refused : {std::int64_t{0}, std::int64_t{499'999'999}, std::int64_t{60'000'000'001}}) {
    session.give_up_ns = refused;
    EXPECT_FALSE(encode(session, now)) << refused;
  }
}

TYPED_TEST(EveryMessage, WithFourBytesTooManyIsRefused) {
  std::mt19937_64 random(3);
  ByteBuffer buffer;
  ASSERT_TRUE(encode(random_message<TypeParam>(random, 7), buffer));
  TypeParam received;
  buffer.insert(buffer.end(), 4, std::byte{0});
  EXPECT_FALSE(decode(buffer, received));
}

TYPED_TEST(EveryMessage, OfRandomBytesNeitherCrashesNorGrows) {
  std::mt19937_64 random(4);
  ByteBuffer buffer;
  TypeParam received;
  for (int i = 0; i < testing::rounds(100'000, 2'000'000); ++i) {
    buffer.resize(4 + random() % 200);
    for (std::byte& b : buffer) b = static_cast<std::byte>(random());
    buffer[0] = std::byte{0};
    buffer[1] = std::byte{1};
    static_cast<void>(decode(buffer, received));
  }
}

// every 4-byte place of a good message, one after the other, becomes a huge length
TYPED_TEST(EveryMessage, WithHugeLengthsIsRefusedOrHarmless) {
  std::mt19937_64 random(5);
  ByteBuffer good;
  ASSERT_TRUE(encode(random_message<TypeParam>(random, 12), good));
  TypeParam received;
  for (const std::uint32_t length : {0xffffffffu, 0x7fffffffu, 0x80000000u, 0x20000000u, 5'000'000u, 70'000u}) {
    for (std::size_t at = 4; at + 4 <= good.size(); at += 4) {
      ByteBuffer bad = good;
      std::memcpy(bad.data() + at, &length, sizeof length);
      static_cast<void>(decode(bad, received));
    }
  }
}

TYPED_TEST(EveryMessage, OfAnotherRepresentationIsRefused) {
  std::mt19937_64 random(6);
  ByteBuffer buffer;
  ASSERT_TRUE(encode(random_message<TypeParam>(random, 3), buffer));
  TypeParam received;
  for (const int identifier : {0, 2, 3, 6, 7, 8, 9, 0x100}) {
    buffer[0] = static_cast<std::byte>(identifier >> 8);
    buffer[1] = static_cast<std::byte>(identifier);
    EXPECT_FALSE(decode(buffer, received)) << identifier;
  }
}

TEST(Codec, RefusesToEncodeAboveTheCaps) {
  ByteBuffer buffer;
  wire::Tick tick;
  tick.commands.resize(wire::kMaxCommandsPerTick);
  tick.commands.back().path.assign(wire::kMaxNameLength, 'a');
  EXPECT_TRUE(encode(tick, buffer));
  tick.commands.back().path += 'a';
  EXPECT_FALSE(encode(tick, buffer));
  tick.commands.back().path = std::string("Bag\0.mass", 9);
  EXPECT_FALSE(encode(tick, buffer));
  tick.commands.assign(wire::kMaxCommandsPerTick + 1, {});
  EXPECT_FALSE(encode(tick, buffer));

  wire::NodeStatus status;
  status.reason.assign(wire::kMaxReasonLength + 1, 'x');
  EXPECT_FALSE(encode(status, buffer));
  status.reason.clear();
  status.heard.resize(wire::kMaxHeard + 1);
  EXPECT_FALSE(encode(status, buffer));
  status.heard.clear();
  status.state = static_cast<wire::NodeState>(8);
  EXPECT_FALSE(encode(status, buffer));

  wire::SessionDescription session;
  session.scene_text.assign(wire::kMaxSceneBytes, ' ');
  EXPECT_TRUE(encode(session, buffer));
  session.scene_text += ' ';
  EXPECT_FALSE(encode(session, buffer));
}

// overwrites a number of an encoded message
template <typename N>
ByteBuffer with_number(ByteBuffer bytes, std::size_t at, N number) {
  std::memcpy(bytes.data() + at, &number, sizeof number);
  return bytes;
}

TEST(Codec, RefusesStepsAndNumbersOfVariablesOutOfRange) {
  constexpr std::size_t kStepAt = 4 + 32;  // offset in every header
  ByteBuffer buffer;
  wire::Tick tick;
  tick.header.step = wire::kMaxStep;
  ASSERT_TRUE(encode(tick, buffer));
  ASSERT_TRUE(decode(buffer, tick));
  wire::Header header;
  for (const std::int64_t step :
       {wire::kMaxStep + 1, std::int64_t{INT64_MAX}, std::int64_t{INT64_MIN}, kJoinStep - 1}) {
    EXPECT_FALSE(decode(with_number(buffer, kStepAt, step), tick)) << step;
    EXPECT_FALSE(decode_header(with_number(buffer, kStepAt, step), header)) << step;
    tick.header.step = step;
    ByteBuffer unsent;
    EXPECT_FALSE(encode(tick, unsent)) << step;
  }
  EXPECT_TRUE(decode(with_number(buffer, kStepAt, kJoinStep), tick));

  wire::VariableDirectory directory;
  directory.total = wire::kMaxVariables;
  directory.first = wire::kMaxVariables - 1;
  ASSERT_TRUE(encode(directory, buffer));
  ASSERT_TRUE(decode(buffer, directory));
  EXPECT_FALSE(decode(with_number(buffer, kStepAt + 8, std::uint32_t{4'000'000'000}), directory));
  EXPECT_FALSE(decode(with_number(buffer, kStepAt + 12, std::uint32_t{wire::kMaxVariables}), directory));
  wire::VariableBlock block;
  ASSERT_TRUE(encode(block, buffer));
  EXPECT_FALSE(decode(with_number(buffer, kStepAt + 8, std::uint32_t{4'000'000'000}), block));
  wire::ResendRequest request;
  ASSERT_TRUE(encode(request, buffer));
  ASSERT_TRUE(decode(buffer, request));
  EXPECT_FALSE(decode(with_number(buffer, buffer.size() - 8, std::int64_t{INT64_MAX}), request));
}

// offset of the first byte that changes when the message changes
template <typename M>
std::size_t first_difference(const M& a, const M& b) {
  ByteBuffer first, second;
  EXPECT_TRUE(encode(a, first));
  EXPECT_TRUE(encode(b, second));
  std::size_t at = 4;
  while (at < first.size() && first[at] == second[at]) ++at;
  return at;
}

TEST(Codec, RefusesLengthsAboveTheCapEvenWhenTheBytesAreThere) {
  wire::VariableBlock empty, one;
  one.values.push_back(1.0);
  const std::size_t length_at = first_difference(empty, one);
  ByteBuffer buffer;
  ASSERT_TRUE(encode(empty, buffer));
  buffer.resize(length_at + 4 + 8 * (wire::kMaxVariablesPerBlock + 2), std::byte{0});
  const std::uint32_t length = wire::kMaxVariablesPerBlock + 1;
  std::memcpy(buffer.data() + length_at, &length, sizeof length);
  wire::VariableBlock received;
  EXPECT_FALSE(decode(buffer, received));
}

TEST(Codec, RefusesUnknownEnumeratorsBooleansAndTextsWithoutEnd) {
  ByteBuffer buffer;
  wire::Health calm, waiting;
  waiting.is_waiting = true;
  ASSERT_TRUE(encode(waiting, buffer));
  const std::size_t flag_at = first_difference(calm, waiting);
  buffer[flag_at] = std::byte{2};
  wire::Health health;
  EXPECT_FALSE(decode(buffer, health));

  wire::Health fault;
  fault.state = wire::NodeState::fault;
  ASSERT_TRUE(encode(calm, buffer));
  buffer[first_difference(calm, fault)] = std::byte{8};
  EXPECT_FALSE(decode(buffer, health));

  wire::ControlReply reply, answered;
  answered.reason = "abc";
  const std::size_t length_at = first_difference(reply, answered);
  ASSERT_TRUE(encode(answered, buffer));
  wire::ControlReply received;
  ASSERT_TRUE(decode(buffer, received));
  buffer[length_at + 4 + 3] = std::byte{'d'};
  EXPECT_FALSE(decode(buffer, received));
  buffer[length_at + 4 + 3] = std::byte{0};
  buffer[length_at + 4 + 1] = std::byte{0};
  EXPECT_FALSE(decode(buffer, received));
}

TEST(Codec, ReadsTheHeaderAlone) {
  std::mt19937_64 random(7);
  const auto sent = random_message<wire::MechanismMessage>(random, 3);
  ByteBuffer buffer;
  ASSERT_TRUE(encode(sent, buffer));
  wire::Header header;
  ASSERT_TRUE(decode_header(buffer, header));
  EXPECT_TRUE(header == sent.header);
  EXPECT_FALSE(decode_header(Bytes(buffer).first(43), header));
  EXPECT_TRUE(decode_header(Bytes(buffer).first(44), header));
}

template <typename M>
void expect_no_allocation_after_warm_up(M message) {
  ByteBuffer buffer;
  M received;
  ASSERT_TRUE(encode(message, buffer) && decode(buffer, received));
  const AllocationGuard guard;
  bool is_good = true;
  for (int i = 0; i < 1000; ++i) is_good = encode(message, buffer) && decode(buffer, received) && is_good;
  EXPECT_EQ(guard.allocations(), 0u);
  EXPECT_TRUE(is_good);
}

TEST(Codec, AllocatesNothingForStepMessagesAfterWarmUp) {
  std::mt19937_64 random(8);
  expect_no_allocation_after_warm_up(random_message<wire::MechanismMessage>(random, 16));
  expect_no_allocation_after_warm_up(random_message<wire::ActuatorMessage>(random, 16));
  expect_no_allocation_after_warm_up(random_message<wire::VariableBlock>(random, 1024));
  auto tick = random_message<wire::Tick>(random, 64);
  expect_no_allocation_after_warm_up(tick);
  tick.commands.clear();
  expect_no_allocation_after_warm_up(tick);
}

}  // namespace codec_test
}  // namespace slew::transport
