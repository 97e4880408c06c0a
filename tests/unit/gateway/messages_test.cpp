// SPDX-License-Identifier: Apache-2.0
// Bytes and texts of the Foxglove protocol, against its published layout.
#include <gtest/gtest.h>

#include <limits>

#include "gateway/client_messages.h"
#include "gateway/server_messages.h"

namespace messages_test {

using namespace slew;
using namespace slew::gateway;

std::string bytes(std::initializer_list<int> values) {
  std::string text;
  for (const int value : values) text.push_back(static_cast<char>(value));
  return text;
}

// foxglove/ws-protocol, docs/spec.md: opcode, subscription u32, time u64, little-endian
TEST(ServerMessages, HaveThePublishedBytes) {
  EXPECT_EQ(message_head(0x01020304, 0x1122334455667788),
            bytes({1, 4, 3, 2, 1, 0x88, 0x77, 0x66, 0x55, 0x44, 0x33, 0x22, 0x11}));
  EXPECT_EQ(time_bytes(258), bytes({2, 2, 1, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(service_response_bytes(7, 9, Json({{"a", 1}})),
            bytes({3, 7, 0, 0, 0, 9, 0, 0, 0, 4, 0, 0, 0}) + "json{\"a\":1}");
  EXPECT_EQ(asset_head(7), bytes({4, 7, 0, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(asset_failure_bytes(7, "no"), bytes({4, 7, 0, 0, 0, 1, 2, 0, 0, 0, 'n', 'o'}));
  // foxglove-sdk, ws_protocol/server/playback_state.rs: status u8, time u64, speed f32, did_seek u8, id
  EXPECT_EQ(playback_state_bytes({PlaybackStatus::ended, 1, 1.0F, true, "ab"}),
            bytes({5, 3, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0x80, 0x3f, 1, 2, 0, 0, 0, 'a', 'b'}));
}

TEST(ServerMessages, ServerInfoHasTheRangeOfARecordingAlone) {
  ServerInfo info;
  info.name = "crane";
  info.session_id = "1-0";
  info.capabilities = {"time"};
  EXPECT_EQ(Json::parse(to_text(info))->find("dataStartTime"), nullptr);
  info.range = DataRange{0, 2'500'000'001};
  const Json json = *Json::parse(to_text(info));
  EXPECT_EQ(json.at("op").text(), "serverInfo");
  EXPECT_EQ(json.at("sessionId").text(), "1-0");
  EXPECT_EQ(json.at("dataEndTime").at("sec").integer(), 2);
  EXPECT_EQ(json.at("dataEndTime").at("nsec").integer(), 500'000'001);
}

template <typename Message>
Message taken(const DecodedMessage& decoded) {
  EXPECT_TRUE(decoded.message.has_value()) << decoded.problem;
  return std::get<Message>(*decoded.message);
}

TEST(ClientMessages, AreReadFromTheirTexts) {
  const auto subscribe = taken<Subscribe>(
      decode_text(R"({"op":"subscribe","subscriptions":[{"id":0,"channelId":3},{"id":4294967295,"channelId":5}]})"));
  ASSERT_EQ(subscribe.subscriptions.size(), 2u);
  EXPECT_EQ(subscribe.subscriptions[0].channel, 3u);
  EXPECT_EQ(subscribe.subscriptions[1].id, 4294967295u);
  const auto set = taken<SetParameters>(decode_text(
      R"({"op":"setParameters","parameters":[{"name":"Bag.mass","value":1500},{"name":"a.b","value":"1 t"}],"id":"x"})"));
  EXPECT_EQ(std::get<double>(set.changes[0].value), 1500);
  EXPECT_EQ(std::get<std::string>(set.changes[1].value), "1 t");
  EXPECT_EQ(set.id, "x");
  EXPECT_TRUE(taken<GetParameters>(decode_text(R"({"op":"getParameters","parameterNames":[]})")).names.empty());
  EXPECT_EQ(
      taken<Advertise>(
          decode_text(
              R"({"op":"advertise","channels":[{"id":1,"topic":"/inputs/A","encoding":"json","schemaName":"x"}]})"))
          .channels[0]
          .topic,
      "/inputs/A");
}

TEST(ClientMessages, AreReadFromTheirBytes) {
  const std::string publish = bytes({1, 2, 0, 0, 0}) + "{}";
  EXPECT_EQ(taken<Publish>(decode_binary(publish)).bytes, "{}");
  const std::string call = bytes({2, 5, 0, 0, 0, 6, 0, 0, 0, 4, 0, 0, 0}) + "json{}";
  EXPECT_EQ(taken<ServiceCall>(decode_binary(call)).call, 6u);
  EXPECT_EQ(taken<ServiceCall>(decode_binary(call)).encoding, "json");
  const std::string seek = bytes({3, 1, 0, 0, 0, 0x40, 1, 2, 1, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 'r'});
  const auto control = taken<PlaybackControl>(decode_binary(seek));
  EXPECT_TRUE(control.is_paused);
  EXPECT_EQ(control.speed, 2.0F);
  EXPECT_EQ(control.seek_ns, 258u);
  EXPECT_EQ(control.id, "r");
}

TEST(ClientMessages, WhatIsNoMessageIsRefusedWithASentence) {
  const std::string deep = R"({"op":)" + std::string(500'000, '[') + "}";
  for (const std::string& text :
       {std::string(), std::string("{}"), std::string("[]"), std::string("{\"op\":1}"),
        std::string(R"({"op":"dance"})"), std::string(R"({"op":"subscribe"})"),
        std::string(R"({"op":"subscribe","subscriptions":{}})"),
        std::string(R"({"op":"subscribe","subscriptions":[{"id":-1,"channelId":1}]})"),
        std::string(R"({"op":"subscribe","subscriptions":[{"id":1.5,"channelId":1}]})"),
        std::string(R"({"op":"setParameters","parameters":[{"name":"a","value":null}]})"),
        std::string(R"({"op":"getParameters","parameterNames":[")") + std::string(2000, 'a') + R"("]})", deep}) {
    const DecodedMessage decoded = decode_text(text);
    EXPECT_FALSE(decoded.message.has_value()) << text.substr(0, 80);
    EXPECT_NE(decoded.problem.find("the message was ignored"), std::string::npos);
    EXPECT_LT(decoded.problem.size(), 400u);
  }
  const std::string call = bytes({2, 5, 0, 0, 0, 6, 0, 0, 0, 4, 0, 0, 0}) + "json";
  for (std::size_t size = 0; size < call.size(); ++size)
    EXPECT_FALSE(decode_binary(call.substr(0, size)).message.has_value()) << size;
  EXPECT_FALSE(decode_binary(bytes({9, 0, 0})).message.has_value());
  EXPECT_FALSE(decode_binary(bytes({2, 5, 0, 0, 0, 6, 0, 0, 0, 255, 255, 255, 255})).message.has_value());
}

}  // namespace messages_test
