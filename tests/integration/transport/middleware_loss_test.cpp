// SPDX-License-Identifier: Apache-2.0
// A stream whose reader, in another process, does not run for a while.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/integration/transport/child_process.h"
#include "tests/integration/transport/middlewares.h"
#include "tests/integration/transport/waiting.h"
#include "transport/cdr/codec.h"

namespace slew::transport {
namespace middleware_loss_test {

using testing::ChildProcess;
using testing::eventually;
using testing::next;
using wire::Topic;

constexpr StepIndex kSteps = 4000;
constexpr std::int64_t kPeriod = 250'000;  // ns, of the paced stream: 4 kHz
constexpr StepIndex kStopAt = 1000;
constexpr StepIndex kStopFor = 800;   // steps
constexpr StepIndex kReported = 200;  // steps from one report of the reader to the next

bool report(Transport& transport) {
  ByteBuffer bytes;
  return encode(wire::NodeStatus{}, bytes) && transport.publish(Topic::node_status, bytes).is_ok();
}

// Publishes a status when the writer has been discovered.
bool publish_ready(Transport& transport) {
  return eventually([&] { return !transport.discovered_writers(Topic::tick).empty(); }) && report(transport);
}

// the recorder's place: every step of both topics, in order
bool receive_every_step(const Network& network) {
  std::unique_ptr<Transport> transport;
  const Endpoint options{"loss", "recorder", {Topic::node_status}, {Topic::tick, Topic::variables}};
  if (!open_transport(network, options, transport).is_ok()) return false;
  if (!publish_ready(*transport)) return false;
  StepIndex next_tick = 0;
  StepIndex next_block = 0;
  StepIndex reported = 0;
  Received message;
  wire::Header header;
  while (next_tick < kSteps || next_block < kSteps) {
    if (!next(*transport, message) || !decode_header(message.bytes, header)) return false;
    StepIndex& expected = message.topic == Topic::tick ? next_tick : next_block;
    if (header.step != expected++) {
      std::fprintf(stderr, "step %lld came instead of %lld\n", static_cast<long long>(header.step),
                   static_cast<long long>(expected - 1));
      return false;
    }
    if (std::min(next_tick, next_block) >= reported + kReported) {
      reported += kReported;
      if (!report(*transport)) return false;
    }
  }
  return true;
}

enum class Stream : std::uint8_t {
  // For the reports of a reader that runs: it never has more before it than a writer keeps. Without a clock, so that
  // the
  // stop stays far below the 2 s after which DDS takes a silent participant for gone, on a busy machine too.
  waiting,
  paced,  // as in a session: a reader that gets no processor for 50 ms behind its stop loses steps
};

void expect_no_step_lost(const Network& network, Stream stream) {
  ChildProcess recorder([&] { return receive_every_step(network); });
  std::unique_ptr<Transport> transport;
  const Status status =
      open_transport(network, {"loss", "io", {Topic::tick, Topic::variables}, {Topic::node_status}}, transport);
  ASSERT_TRUE(status.is_ok()) << status.text;
  Received received;
  ASSERT_TRUE(next(*transport, received));
  // a reader of Fast DDS may have discovered the writer before the writer has matched it
  ASSERT_TRUE(eventually(
      [&] { return transport->matched_readers(Topic::tick) > 0 && transport->matched_readers(Topic::variables) > 0; }));
  wire::Tick tick;
  tick.controls.resize(4);
  tick.age.resize(4);
  wire::VariableBlock block;
  block.values.resize(100);
  ByteBuffer bytes;
  StepIndex reported = 0;
  const std::int64_t start = monotonic_ns();
  for (StepIndex n = 0; n < kSteps; ++n) {
    const bool is_stopped = n > kStopAt && n < kStopAt + kStopFor;
    if (n == kStopAt + kStopFor) recorder.send(SIGCONT);
    while (stream == Stream::waiting && !is_stopped && reported + kReported <= n) {
      ASSERT_TRUE(next(*transport, received)) << "the reader has lost a step before " << n;
      reported += kReported;
    }
    if (n == kStopAt) recorder.send(SIGSTOP);
    tick.header.step = n;
    block.header.step = n;
    ASSERT_TRUE(encode(tick, bytes) && transport->publish(Topic::tick, bytes).is_ok());
    ASSERT_TRUE(encode(block, bytes) && transport->publish(Topic::variables, bytes).is_ok());
    if (stream == Stream::paced) sleep_until_monotonic(start + (n + 1) * kPeriod);
  }
  EXPECT_EQ(recorder.wait(), 0);
}

class Loss : public testing::OverMiddleware {};
INSTANTIATE_TEST_SUITE_P(Over, Loss, testing::kAllMiddlewares, testing::name_of);

TEST_P(Loss, AReaderStoppedFor800StepsLosesNothing) {
  expect_no_step_lost(network(), Stream::waiting);
}

TEST_P(Loss, NightlyAReaderStoppedFor200MillisecondsAtFourKilohertzLosesNothing) {
  expect_no_step_lost(network(), Stream::paced);
}

bool receive_ticks(const Network& network, StepIndex count) {
  std::unique_ptr<Transport> transport;
  const Endpoint options{"loss", "recorder", {Topic::node_status}, {Topic::tick}};
  if (!open_transport(network, options, transport).is_ok()) return false;
  if (!publish_ready(*transport)) return false;
  Received message;
  wire::Header header;
  for (StepIndex n = 0; n < count; ++n) {
    if (!next(*transport, message) || !decode_header(message.bytes, header) || header.step != n) return false;
  }
  return true;
}

TEST_P(Loss, TheLastMessagesOfALeavingWriterArrive) {
  constexpr StepIndex kCount = 1000;
  ChildProcess recorder([&] { return receive_ticks(network(), kCount); });
  std::unique_ptr<Transport> transport;
  const Status status = open_transport(network(), {"loss", "io", {Topic::tick}, {Topic::node_status}}, transport);
  ASSERT_TRUE(status.is_ok()) << status.text;
  Received ready;
  ASSERT_TRUE(next(*transport, ready));
  wire::Tick tick;
  ByteBuffer bytes;
  for (StepIndex n = 0; n < kCount; ++n) {
    tick.header.step = n;
    ASSERT_TRUE(encode(tick, bytes) && transport->publish(Topic::tick, bytes).is_ok());
  }
  transport.reset();
  EXPECT_EQ(recorder.wait(), 0);
}

bool receive_the_session(const Network& network) {
  std::unique_ptr<Transport> transport;
  const Endpoint options{"loss", "mechanics", {}, {Topic::session}};
  if (!open_transport(network, options, transport).is_ok()) return false;
  Received message;
  wire::SessionDescription session;
  return next(*transport, message) && decode(message.bytes, session) &&
         session.scene_text == std::string(wire::kMaxSceneBytes, 'x');
}

TEST_P(Loss, TheLargestSceneReachesALateNode) {
  // a signal starts the late node; before that, no part of DDS may exist in this process
  ChildProcess node([&] {
    raise(SIGSTOP);
    return receive_the_session(network());
  });
  ASSERT_TRUE(node.wait_until_stopped());
  std::unique_ptr<Transport> transport;
  const Status status = open_transport(network(), {"loss", "io", {Topic::session}, {}}, transport);
  ASSERT_TRUE(status.is_ok()) << status.text;
  wire::SessionDescription session;
  session.scene_text.assign(wire::kMaxSceneBytes, 'x');
  ByteBuffer bytes;
  ASSERT_TRUE(encode(session, bytes));
  ASSERT_TRUE(transport->publish(Topic::session, bytes).is_ok());
  node.send(SIGCONT);
  EXPECT_EQ(node.wait(), 0);
}

}  // namespace middleware_loss_test
}  // namespace slew::transport
