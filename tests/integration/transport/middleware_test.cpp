// SPDX-License-Identifier: Apache-2.0
// Claims about every middleware, and those about the configuration of Cyclone.
#include <gtest/gtest.h>
#include <unistd.h>

#include <climits>

#include "tests/integration/transport/child_process.h"
#include "tests/integration/transport/middlewares.h"
#include "tests/integration/transport/waiting.h"
#include "transport/cdr/codec.h"
#include "transport/cyclone/cyclone_domain.h"

namespace slew::transport {
namespace middleware_test {

using testing::eventually;
using testing::next;
using wire::Topic;

constexpr std::int64_t kSilence = 50'000'000;  // ns in which nothing more may come

// Several transports of one process on a test domain.
class Bus : public testing::OverMiddleware {
 protected:
  using OverMiddleware::connect;
  std::unique_ptr<Transport> connect(const std::string& session, const std::string& role, TopicSet writes,
                                     TopicSet reads) const {
    return connect(Endpoint{session, role, writes, reads});
  }
};
INSTANTIATE_TEST_SUITE_P(Over, Bus, testing::kAllMiddlewares, testing::name_of);

ByteBuffer status_of(wire::Role role, std::int32_t number) {
  wire::NodeStatus status;
  status.header.role = role;
  status.exit_code = number;
  ByteBuffer bytes;
  EXPECT_TRUE(encode(status, bytes));
  return bytes;
}

ByteBuffer tick_of(StepIndex step) {
  wire::Tick tick;
  tick.header.step = step;
  ByteBuffer bytes;
  EXPECT_TRUE(encode(tick, bytes));
  return bytes;
}

TEST_P(Bus, CarriesMessagesInOrder) {
  const auto io = connect("a", "io", {Topic::tick}, {});
  const auto node = connect("a", "mechanics", {}, {Topic::tick});
  ASSERT_TRUE(eventually([&] { return io->matched_readers(Topic::tick) == 1; }));
  for (StepIndex n = 0; n < 500; ++n) ASSERT_TRUE(io->publish(Topic::tick, tick_of(n)).is_ok());
  Received message;
  wire::Header header;
  for (StepIndex n = 0; n < 500; ++n) {
    ASSERT_TRUE(next(*node, message));
    ASSERT_EQ(message.topic, Topic::tick);
    ASSERT_TRUE(decode_header(message.bytes, header));
    ASSERT_EQ(header.step, n);
    ASSERT_EQ(ByteBuffer(message.bytes.begin(), message.bytes.end()), tick_of(n));
  }
}

TEST_P(Bus, DistinguishesTheWritersOfValuesAndSeesThemLeave) {
  const auto io = connect("a", "io", {}, {Topic::controller_input});
  const auto a = connect("a", "controller", {Topic::controller_input}, {});
  auto b = connect("a", "controller", {Topic::controller_input}, {});
  ASSERT_TRUE(eventually([&] { return a->matched_readers(Topic::controller_input) == 1; }));
  ASSERT_TRUE(eventually([&] { return b->matched_readers(Topic::controller_input) == 1; }));
  wire::ControllerInput input;
  ByteBuffer bytes;
  ASSERT_TRUE(encode(input, bytes));
  Received message;
  const auto writer = [&](Transport& from) {
    EXPECT_TRUE(from.publish(Topic::controller_input, bytes).is_ok());
    EXPECT_TRUE(next(*io, message));
    return message.writer;
  };
  const std::uint64_t of_a = writer(*a), of_b = writer(*b);
  EXPECT_NE(of_a, 0u);
  EXPECT_NE(of_b, 0u);
  EXPECT_NE(of_a, of_b);
  EXPECT_EQ(writer(*a), of_a);
  char host[HOST_NAME_MAX + 1] = "";
  ASSERT_EQ(gethostname(host, sizeof host - 1), 0);
  EXPECT_EQ(io->see_writer(Topic::controller_input, of_a).process,
            "process " + std::to_string(getpid()) + " on " + host);
  b.reset();
  EXPECT_TRUE(eventually([&] { return io->see_writer(Topic::controller_input, of_b).has_left; }));
  EXPECT_FALSE(io->see_writer(Topic::controller_input, of_a).has_left);
}

TEST_P(Bus, AnEndpointDoesNotReceiveItsOwnMessages) {
  const auto a = connect("a", "io", TopicSet::all(), TopicSet::all());
  const auto b = connect("a", "mechanics", TopicSet::all(), TopicSet::all());
  ASSERT_TRUE(eventually([&] { return a->matched_readers(Topic::tick) == 1; }));
  ASSERT_TRUE(a->publish(Topic::tick, tick_of(1)).is_ok());
  Received message;
  EXPECT_TRUE(next(*b, message));
  EXPECT_FALSE(next(*a, message, kSilence));
}

TEST_P(Bus, SessionsAreSeparateAndAnObserverReceivesAll) {
  const auto a = connect("a", "io", {Topic::tick}, {});
  const auto b = connect("b", "io", {Topic::tick}, {});
  const auto node_a = connect("a", "mechanics", {}, {Topic::tick});
  const auto observer = connect(kAnySession, "observer", {}, {Topic::tick});
  ASSERT_TRUE(eventually([&] { return a->matched_readers(Topic::tick) == 2; }));
  ASSERT_TRUE(eventually([&] { return b->matched_readers(Topic::tick) == 1; }));
  ASSERT_TRUE(b->publish(Topic::tick, tick_of(2)).is_ok());
  ASSERT_TRUE(a->publish(Topic::tick, tick_of(1)).is_ok());
  Received message;
  wire::Header header;
  ASSERT_TRUE(next(*node_a, message));
  ASSERT_TRUE(decode_header(message.bytes, header));
  EXPECT_EQ(header.step, 1);
  EXPECT_FALSE(next(*node_a, message, kSilence));
  EXPECT_TRUE(next(*observer, message));
  EXPECT_TRUE(next(*observer, message));
}

TEST_P(Bus, ALateNodeGetsEachWritersLastStatus) {
  const auto io = connect("a", "io", {Topic::node_status}, {});
  const auto mechanics = connect("a", "mechanics", {Topic::node_status}, {});
  const auto hydraulics = connect("a", "hydraulics", {Topic::node_status}, {});
  for (std::int32_t i = 0; i < 10; ++i) {
    ASSERT_TRUE(io->publish(Topic::node_status, status_of(wire::Role::io, i)).is_ok());
    ASSERT_TRUE(mechanics->publish(Topic::node_status, status_of(wire::Role::mechanics, i)).is_ok());
    ASSERT_TRUE(hydraulics->publish(Topic::node_status, status_of(wire::Role::hydraulics, i)).is_ok());
  }
  const auto late = connect("a", "recorder", {}, {Topic::node_status});
  std::uint32_t received_roles = 0;
  Received message;
  wire::NodeStatus status;
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(next(*late, message));
    ASSERT_TRUE(decode(message.bytes, status));
    EXPECT_EQ(status.exit_code, 9);
    received_roles |= bit(status.header.role);
  }
  EXPECT_EQ(received_roles, bit(wire::Role::io) | bit(wire::Role::mechanics) | bit(wire::Role::hydraulics));
  EXPECT_FALSE(next(*late, message, kSilence));
}

TEST_P(Bus, UndeclaredTopicsAreRefused) {
  const auto node = connect("a", "mechanics", {Topic::mechanism}, {Topic::tick});
  EXPECT_FALSE(node->publish(Topic::tick, tick_of(1)).is_ok());
}

TEST_P(Bus, NamesTheWritersOfATopic) {
  const auto io = connect("a", "io", {Topic::tick}, {});
  const auto other = connect("b", "io", {Topic::tick}, {});
  const auto node = connect("a", "mechanics", {}, {Topic::tick});
  std::vector<std::string> writers;
  ASSERT_TRUE(eventually([&] {
    writers = node->discovered_writers(Topic::tick);
    return !writers.empty();
  }));
  ASSERT_EQ(writers.size(), 1u);
  EXPECT_EQ(writers[0].find("io on host "), 0u) << writers[0];
  EXPECT_NE(writers[0].find(", pid " + std::to_string(getpid()) + ", type slewring::Tick"), std::string::npos);
  EXPECT_EQ(writers[0].find("layout"), std::string::npos);
}

TEST_P(Bus, PatternsAreNoSessionNames) {
  for (const char* name : {"", "a*", "?", "[x]"}) {
    std::unique_ptr<Transport> transport;
    EXPECT_EQ(open_transport(network(), {name, "io", {Topic::tick}, {}}, transport).code, ExitCode::bad_input);
  }
}

Status error_of(const Network& network) {
  std::unique_ptr<Transport> transport;
  return open_transport(network, {"a", "observer", {}, {}}, transport);
}

TEST_P(Bus, AMissingInterfaceIsNamedWithThoseThatExist) {
  const Status status = error_of({1, "nonesuch0", {}, {}, GetParam()});
  EXPECT_EQ(status.code, ExitCode::resources);
  EXPECT_NE(status.text.find("'nonesuch0'"), std::string::npos) << status.text;
  EXPECT_NE(status.text.find("lo (127.0.0.1)"), std::string::npos) << status.text;
  EXPECT_NE(status.text.find("--interface"), std::string::npos) << status.text;
}

TEST_P(Bus, WrongPeersAndNumbersAreRefused) {
  EXPECT_EQ(error_of({1, "lo", {"10.0.0.2\"/>"}, {}, GetParam()}).code, ExitCode::bad_input);
  EXPECT_EQ(error_of({kMaxDomain + 1, "lo", {}, {}, GetParam()}).code, ExitCode::bad_input);
}

TEST_P(Bus, TheGreatestDomainHasPortsForAllProcesses) {
  const Status status = error_of({kMaxDomain, "lo", {}, {}, GetParam()});
  EXPECT_TRUE(status.is_ok()) << status.text;
}

TEST_P(Bus, NightlyAnExhaustedParticipantIndexIsExplained) {
  const auto hold = [this] {
    std::unique_ptr<Transport> transport;
    const Status status = open_transport(network(), {"a", "observer", {}, {}}, transport);
    if (!status.is_ok()) {
      std::fprintf(stderr, "%s\n", status.text.c_str());
      return false;
    }
    raise(SIGSTOP);
    return true;
  };
  std::vector<testing::ChildProcess> children;
  for (int i = 0; i < kMaxProcesses; ++i) children.emplace_back(hold);
  for (testing::ChildProcess& child : children) ASSERT_TRUE(child.wait_until_stopped());
  // in a process of its own, as Cyclone leaks memory on this path
  testing::ChildProcess one_too_many([this] {
    const Status status = error_of(network());
    return status.code == ExitCode::resources && status.text.find("--domain") != std::string::npos;
  });
  EXPECT_EQ(one_too_many.wait(), 0);
}

TEST(CycloneLogging, AFloodOfMessagesBecomesOneLine) {
  ::testing::internal::CaptureStderr();
  {
    CycloneLog log;
    for (int i = 0; i < 1000; ++i) log.write("sendmsg failed\n");
    EXPECT_EQ(log.last_line(), "sendmsg failed");
  }
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "slewring: DDS: sendmsg failed\n");
}

TEST(CycloneConfiguration, SendsOnlyToOwnHostUnlessPeersAreNamed) {
  const std::string alone = cyclone_xml({0, "lo", {}}, "127.0.0.1");
  EXPECT_NE(alone.find(R"(<Peers><Peer Address="127.0.0.1"/></Peers>)"), std::string::npos);
  EXPECT_NE(alone.find("<AllowMulticast>false</AllowMulticast>"), std::string::npos);
  const std::string two = cyclone_xml({0, "eth0", {"10.0.0.2"}}, "10.0.0.1");
  EXPECT_NE(two.find(R"(<Peers><Peer Address="10.0.0.1"/><Peer Address="10.0.0.2"/></Peers>)"), std::string::npos);
}

}  // namespace middleware_test
}  // namespace slew::transport
