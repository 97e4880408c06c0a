// SPDX-License-Identifier: Apache-2.0
#include "transport/in_process/in_process_bus.h"

#include <gtest/gtest.h>

#include <cstring>
#include <memory>
#include <thread>

#include "core/allocation_guard.h"
#include "core/time.h"
#include "transport/message_object.h"

namespace slew::transport {
namespace in_process_bus_test {

using wire::Topic;

constexpr std::int64_t kForever = 20'000'000'000;  // ns

struct NumberedBytes {
  explicit NumberedBytes(std::uint64_t number) { std::memcpy(bytes.data(), &number, sizeof number); }
  std::array<std::byte, 400> bytes{};
};

std::uint64_t number_of(const Received& message) {
  std::uint64_t number = 0;
  std::memcpy(&number, message.bytes.data(), sizeof number);
  return number;
}

std::vector<std::uint64_t> take_all(Transport& endpoint) {
  std::vector<std::uint64_t> numbers;
  Received message;
  while (endpoint.take(message)) numbers.push_back(number_of(message));
  return numbers;
}

using Numbers = std::vector<std::uint64_t>;

TEST(InProcessBus, DeliversInTheOrderOfPublishingWhoeverPublishes) {
  InProcessBus bus;
  InProcessEndpoint a(bus, {"a", {Topic::tick}, {Topic::mechanism}});
  InProcessEndpoint b(bus, {"b", {Topic::mechanism}, {Topic::tick}});
  InProcessEndpoint c(bus, {"c", {}, {Topic::tick, Topic::mechanism}});
  for (std::uint64_t i = 0; i < 200; ++i) {
    const Status status = (i % 3 == 0 ? a.publish(Topic::tick, NumberedBytes(i).bytes)
                                      : b.publish(Topic::mechanism, NumberedBytes(i).bytes));
    ASSERT_TRUE(status.is_ok());
  }
  const Numbers numbers = take_all(c);
  ASSERT_EQ(numbers.size(), 200u);
  for (std::uint64_t i = 0; i < 200; ++i) EXPECT_EQ(numbers[i], i);
  EXPECT_EQ(take_all(b).size(), 67u);
}

// A tick of this step, published as an object; the bytes that it was encoded to.
std::vector<std::byte> publish_tick(InProcessEndpoint& from, MessagePool<wire::Tick>& pool, StepIndex step) {
  const std::shared_ptr<wire::Tick>& tick = pool.take();
  tick->header.step = step;
  std::vector<std::byte> buffer{std::byte{1}};
  EXPECT_TRUE(from.publish_object(object_of<wire::Tick>(tick), buffer).is_ok());
  return buffer;
}

TEST(InProcessBus, GivesAnObjectToReadersThatTakeObjectsAndEncodesItForTheOthersAlone) {
  InProcessBus bus;
  InProcessEndpoint writer(bus, {"writer", {Topic::tick}, {}});
  InProcessEndpoint reader(bus, {"reader", {}, {Topic::tick}, {Topic::tick}});
  MessagePool<wire::Tick> pool;
  EXPECT_FALSE(writer.needs_bytes(Topic::tick));
  EXPECT_TRUE(publish_tick(writer, pool, 7).empty()) << "no reader takes bytes";

  InProcessEndpoint recorder(bus, {"recorder", {}, {Topic::tick}});
  EXPECT_TRUE(writer.needs_bytes(Topic::tick));
  const std::vector<std::byte> bytes = publish_tick(writer, pool, 8);
  Received message;
  wire::Header header;
  for (const StepIndex step : {7, 8}) {
    ASSERT_TRUE(reader.take(message));
    EXPECT_TRUE(message.bytes.empty());
    ASSERT_TRUE(header_of(message, header));
    EXPECT_EQ(header.step, step);
    ASSERT_NE(object_in<wire::Tick>(message), nullptr);
    EXPECT_EQ(object_in<wire::Tick>(message)->header.step, step);
    EXPECT_EQ(object_in<wire::ActuatorMessage>(message), nullptr) << "an object of another type";
  }
  ASSERT_TRUE(recorder.take(message));
  EXPECT_EQ(message.object, nullptr);
  EXPECT_TRUE(std::equal(bytes.begin(), bytes.end(), message.bytes.begin(), message.bytes.end()));
  ASSERT_TRUE(header_of(message, header));
  EXPECT_EQ(header.step, 8);
  EXPECT_FALSE(recorder.take(message));
}

TEST(InProcessBus, AReaderOfObjectsTakesBytesWhereTheWriterHasNoObject) {
  InProcessBus bus;
  InProcessEndpoint writer(bus, {"writer", {Topic::tick}, {}});
  InProcessEndpoint reader(bus, {"reader", {}, {Topic::tick}, {Topic::tick}});
  ASSERT_TRUE(writer.publish(Topic::tick, NumberedBytes(3).bytes).is_ok());
  EXPECT_EQ(take_all(reader), Numbers{3});
}

TEST(InProcessBus, AnObjectIsNotFilledAgainWhileAReaderHoldsIt) {
  InProcessBus bus;
  InProcessEndpoint writer(bus, {"writer", {Topic::tick}, {}});
  InProcessEndpoint reader(bus, {"reader", {}, {Topic::tick}, {Topic::tick}});
  MessagePool<wire::Tick> pool;
  std::vector<std::shared_ptr<const wire::Tick>> held;
  Received message;
  for (StepIndex step = 0; step < 50; ++step) {
    publish_tick(writer, pool, step);
    ASSERT_TRUE(reader.take(message));
    held.push_back(object_in<wire::Tick>(message));
  }
  for (StepIndex step = 0; step < 50; ++step) EXPECT_EQ(held[static_cast<std::size_t>(step)]->header.step, step);
  const wire::Tick* first = held.front().get();
  held.erase(held.begin(), held.begin() + 1);
  EXPECT_EQ(pool.take().get(), first) << "the one that is free again";
}

TEST(InProcessBus, DistinguishesTheWritersOfValuesAndSeesThemLeave) {
  InProcessBus bus;
  InProcessEndpoint io(bus, {"io", {}, {Topic::controller_input, Topic::tick}});
  InProcessEndpoint a(bus, {"a", {Topic::controller_input, Topic::tick}, {}});
  auto b = std::make_unique<InProcessEndpoint>(bus, InProcessOptions{"b", {Topic::controller_input}, {}});
  Received message;
  const auto writer = [&](InProcessEndpoint& from, Topic topic) {
    EXPECT_TRUE(from.publish(topic, NumberedBytes(1).bytes).is_ok());
    EXPECT_TRUE(io.take(message));
    return message.writer;
  };
  const std::uint64_t of_a = writer(a, Topic::controller_input), of_b = writer(*b, Topic::controller_input);
  EXPECT_NE(of_a, 0u);
  EXPECT_NE(of_a, of_b);
  EXPECT_EQ(writer(a, Topic::controller_input), of_a);
  EXPECT_EQ(writer(a, Topic::tick), 0u) << "it has no reader";
  b.reset();
  EXPECT_FALSE(io.see_writer(Topic::controller_input, of_a).has_left);
  EXPECT_TRUE(io.see_writer(Topic::controller_input, of_b).has_left);
  EXPECT_FALSE(io.see_writer(Topic::controller_input, 0).has_left) << "not known";
}

TEST(InProcessBus, AnEndpointReceivesNeitherItsOwnMessagesNorUnwantedTopics) {
  InProcessBus bus;
  InProcessEndpoint a(bus, {"a", TopicSet::all(), TopicSet::all()});
  InProcessEndpoint b(bus, {"b", {}, {Topic::health}});
  ASSERT_TRUE(a.publish(Topic::tick, NumberedBytes(1).bytes).is_ok());
  ASSERT_TRUE(a.publish(Topic::health, NumberedBytes(2).bytes).is_ok());
  EXPECT_EQ(take_all(a), Numbers{});
  EXPECT_EQ(take_all(b), Numbers{2});
}

TEST(InProcessBus, ALateEndpointGetsEachWritersLastKeptMessages) {
  InProcessBus bus;
  InProcessEndpoint a(bus, {"a", TopicSet::all(), {}});
  InProcessEndpoint b(bus, {"b", TopicSet::all(), {}});
  for (const std::uint64_t i : {1u, 2u, 3u}) {
    ASSERT_TRUE(a.publish(Topic::node_status, NumberedBytes(i).bytes).is_ok());
    ASSERT_TRUE(b.publish(Topic::node_status, NumberedBytes(10 + i).bytes).is_ok());
    ASSERT_TRUE(a.publish(Topic::variable_directory, NumberedBytes(20 + i).bytes).is_ok());
    ASSERT_TRUE(a.publish(Topic::tick, NumberedBytes(30 + i).bytes).is_ok());
  }
  InProcessEndpoint late(bus, {"late", {}, TopicSet::all()});
  EXPECT_EQ(take_all(late), (Numbers{21, 22, 3, 23, 13}));
}

TEST(InProcessBus, WhatALeftWriterKeptIsGone) {
  InProcessBus bus;
  {
    InProcessEndpoint a(bus, {"a", TopicSet::all(), {}});
    ASSERT_TRUE(a.publish(Topic::session, NumberedBytes(1).bytes).is_ok());
  }
  InProcessEndpoint late(bus, {"late", {}, TopicSet::all()});
  EXPECT_EQ(take_all(late), Numbers{});
}

TEST(InProcessBus, UndeclaredTopicsAreRefused) {
  InProcessBus bus;
  InProcessEndpoint a(bus, {"a", {Topic::tick}, {}});
  EXPECT_FALSE(a.publish(Topic::health, NumberedBytes(1).bytes).is_ok());
}

TEST(InProcessBus, NamesTheWritersOfATopic) {
  InProcessBus bus;
  InProcessEndpoint a(bus, {"mechanics", {Topic::mechanism}, {}});
  InProcessEndpoint b(bus, {"hydraulics", {Topic::actuators}, {}});
  EXPECT_EQ(b.discovered_writers(Topic::mechanism),
            std::vector<std::string>{"mechanics in this process, type slewring::MechanismMessage"});
  EXPECT_TRUE(b.discovered_writers(Topic::tick).empty());
}

TEST(InProcessBus, AboveItsLimitTheOldestIsDroppedAndCounted) {
  InProcessBus bus;
  InProcessEndpoint a(bus, {"a", {Topic::tick}, {}});
  InProcessEndpoint b(bus, {"b", {}, {Topic::tick}});
  const std::uint64_t count = InProcessBus::kInboxLimit + 5;
  for (std::uint64_t i = 0; i < count; ++i) ASSERT_TRUE(a.publish(Topic::tick, NumberedBytes(i).bytes).is_ok());
  EXPECT_EQ(b.dropped(), 5u);
  const Numbers numbers = take_all(b);
  ASSERT_EQ(numbers.size(), InProcessBus::kInboxLimit);
  EXPECT_EQ(numbers.front(), 5u);
  EXPECT_EQ(numbers.back(), count - 1);
}

TEST(InProcessBus, AllocatesNothingAfterWarmUp) {
  InProcessBus bus;
  InProcessEndpoint a(bus, {"a", {Topic::tick, Topic::variables}, {}});
  InProcessEndpoint b(bus, {"b", {}, TopicSet::all()});
  const std::vector<std::byte> block(8300);
  Received message;
  const auto exchange = [&] {
    for (std::uint64_t i = 0; i < 40; ++i) {
      static_cast<void>(a.publish(Topic::tick, NumberedBytes(i).bytes));
      if (i % 7 == 0) static_cast<void>(a.publish(Topic::variables, block));
    }
    while (b.take(message)) {
    }
  };
  exchange();
  const AllocationGuard guard;
  for (int i = 0; i < 100; ++i) exchange();
  EXPECT_EQ(guard.allocations(), 0u);
}

TEST(InProcessBus, ThreadsExchangeWithoutLossOrDisorder) {
  InProcessBus bus;
  constexpr std::uint64_t kRounds = 20'000;
  InProcessEndpoint a(bus, {"a", {Topic::mechanism}, {Topic::actuators}});
  InProcessEndpoint b(bus, {"b", {Topic::actuators}, {Topic::mechanism}});
  InProcessEndpoint witness(bus, {"witness", {}, {Topic::mechanism, Topic::actuators}});
  // each answers the other's number with the next
  const auto play = [](InProcessEndpoint& self, Topic topic, std::uint64_t first) {
    std::uint64_t expected = first == 0 ? 1 : 0;
    if (first == 0) static_cast<void>(self.publish(topic, NumberedBytes(0).bytes));
    Received message;
    while (expected < kRounds) {
      if (!self.take(message)) {
        self.wait_until(monotonic_ns() + kForever);
        continue;
      }
      ASSERT_EQ(number_of(message), expected);
      static_cast<void>(self.publish(topic, NumberedBytes(expected + 1).bytes));
      expected += 2;
    }
  };
  std::thread partner([&] { play(b, Topic::actuators, 1); });
  std::thread observer([&] {
    std::uint64_t expected = 0;
    Received message;
    while (expected < kRounds) {
      if (!witness.take(message)) {
        witness.wait_until(monotonic_ns() + kForever);
        continue;
      }
      ASSERT_EQ(number_of(message), expected++);
    }
  });
  play(a, Topic::mechanism, 0);
  partner.join();
  observer.join();
}

}  // namespace in_process_bus_test
}  // namespace slew::transport
