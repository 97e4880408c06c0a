// SPDX-License-Identifier: Apache-2.0
// Messages of the wire reach clients byte by byte, and the connection graph names their writers and readers.
#include "gateway_fixture.h"
#include "transport/idl_text.h"

namespace gateway_test {

class WireTest : public GatewayTest {
 protected:
  static GatewayDef wire_def() {
    GatewayDef def;
    def.name = "winch";
    def.wire = observed_topics();
    return def;
  }
  template <typename Message>
  transport::ByteBuffer pass(const Message& message) {
    transport::ByteBuffer bytes;
    EXPECT_TRUE(transport::encode(message, bytes));
    view.take(transport::kTopicOf<Message>, bytes, std::nullopt, &with_wire);
    return bytes;
  }
  Received taken(ClientId client) {
    Received received;
    while (const auto frame = with_wire.next_frame(client)) {
      const std::string bytes = frame->head + (frame->body != nullptr ? *frame->body : "");
      if (frame->type == FrameType::text) {
        received.texts.push_back(*Json::parse(bytes));
      } else {
        received.binaries.push_back(bytes);
      }
    }
    return received;
  }
  void follow(ClientId client, std::uint32_t subscription, std::int64_t channel) {
    with_wire.take_message(client, FrameType::text,
                           R"({"op":"subscribe","subscriptions":[{"id":)" + std::to_string(subscription) +
                               R"(,"channelId":)" + std::to_string(channel) + "}]}",
                           now_ns);
  }
  static std::string text_of(const transport::ByteBuffer& bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }

  Gateway with_wire{wire_def(), scene::load_file(SLEWRING_SOURCE_DIR "/scenes/forces/operated.yaml")};
};

TEST_F(WireTest, AMessageComesUnchangedWithTheTimeOfItsStep) {
  const ClientId client = *with_wire.connect();
  const Received advertised = taken(client);
  const Json* found = nullptr;
  for (const Json& channel : advertised.last("advertise")->at("channels").items())
    if (channel.at("topic").text() == "/wire/health") found = &channel;
  ASSERT_NE(found, nullptr);
  EXPECT_EQ(found->at("encoding").text(), "cdr");
  EXPECT_EQ(found->at("schemaEncoding").text(), "omgidl");
  EXPECT_EQ(found->at("schemaName").text(), "slewring::Health");
  EXPECT_EQ(found->at("schema").text(), transport::idl_text());
  EXPECT_NE(transport::idl_text().find("struct Health"), std::string_view::npos);
  follow(client, 7, found->at("id").integer());
  EXPECT_TRUE(with_wire.wants_wire());
  wire::Health health;
  health.header = header(Role::mechanics, 0, 3);
  const std::string sent = text_of(pass(health));
  wire::Health foreign = health;
  foreign.header.session = {9, 9, 9};
  pass(foreign);
  const Received received = taken(client);
  ASSERT_EQ(received.binaries.size(), 1u) << "that of another session is none";
  EXPECT_EQ(received.binaries[0].substr(0, 13), std::string("\1\7\0\0\0\xc0\xc6\x2d\0\0\0\0\0", 13));
  EXPECT_EQ(received.binaries[0].substr(13), sent);
}

TEST_F(WireTest, WhatIsPublishedOnceReachesThoseThatComeLater) {
  pass(session_);
  wire::VariableDirectory names;
  names.header = header(Role::io, 0, 0);
  names.total = 1;
  names.entries = {{"Stick.raw", "1"}};
  const std::string sent = text_of(pass(names));
  const ClientId client = *with_wire.connect();
  const Received advertised = taken(client);
  follow(client, 1, channel_of(advertised, "/wire/session"));
  follow(client, 2, channel_of(advertised, "/wire/variable_directory"));
  const std::vector<std::string> binaries = taken(client).binaries;
  ASSERT_EQ(binaries.size(), 2u);
  EXPECT_EQ(binaries[1].substr(13), sent);
}

TEST_F(WireTest, AClientThatDoesNotReadLosesMessagesAndReceivesTheirNumber) {
  const ClientId client = *with_wire.connect();
  const Received advertised = taken(client);
  follow(client, 1, channel_of(advertised, "/wire/variables"));
  wire::VariableBlock block;
  block.header = header(Role::mechanics, 0, 1);
  block.values.resize(512);
  std::size_t count = 0;
  for (std::size_t bytes = 0; bytes < 3 * WireQueue::kMostBytes; ++count) bytes += pass(block).size();
  now_ns += 10'000 * kMs;
  with_wire.poll(view, now_ns);
  const Received received = taken(client);
  const std::size_t messages = received.binaries.size();
  EXPECT_LT(messages, count);
  EXPECT_GT(messages, count / 4);
  ASSERT_NE(received.last("status"), nullptr);
  EXPECT_NE(received.last("status")->at("message").text().find(std::to_string(count - messages) + " were left out"),
            std::string::npos);
  EXPECT_EQ(with_wire.close_reason(client), "");
}

TEST_F(WireTest, TheGraphNamesNodesThatTakePart) {
  const ClientId client = *with_wire.connect();
  taken(client);
  with_wire.take_message(client, FrameType::text, R"({"op":"subscribeConnectionGraph"})", now_ns);
  const auto publishers = [](const Received& received, const std::string& topic) {
    const Json* const graph = received.last("connectionGraphUpdate");
    std::vector<std::string> ids;
    if (graph == nullptr) return ids;
    for (const Json& one : graph->at("publishedTopics").items())
      if (one.at("name").text() == topic) ids = one.at("publisherIds").texts();
    return ids;
  };
  const Received before = taken(client);
  ASSERT_NE(before.last("connectionGraphUpdate"), nullptr);
  EXPECT_TRUE(publishers(before, "/wire/mechanism").empty());
  EXPECT_EQ(publishers(before, "/slewring/transforms"), std::vector<std::string>{"window"});
  wire::NodeStatus status;
  status.header = header(Role::mechanics, 0, 0);
  pass(status);
  with_wire.poll(view, now_ns);
  EXPECT_EQ(publishers(taken(client), "/wire/mechanism"), std::vector<std::string>{"mechanics"});
  with_wire.take_message(client, FrameType::text, R"({"op":"unsubscribeConnectionGraph"})", now_ns);
  status.header = header(Role::io, 0, 0);
  pass(status);
  with_wire.poll(view, now_ns);
  EXPECT_EQ(taken(client).last("connectionGraphUpdate"), nullptr);
}

}  // namespace gateway_test
