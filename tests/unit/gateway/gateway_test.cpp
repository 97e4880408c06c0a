// SPDX-License-Identifier: Apache-2.0
// What clients of a gateway receive.
#include "gateway_fixture.h"

namespace gateway_test {

TEST_F(GatewayTest, AClientReceivesServerInfoChannelsAndServices) {
  const Received received = take_all(connect());
  ASSERT_GE(received.texts.size(), 3u);
  const Json& info = received.texts[0];
  EXPECT_EQ(info.at("op").text(), "serverInfo");
  EXPECT_EQ(info.at("capabilities").texts(),
            (std::vector<std::string>{"time", "connectionGraph", "parameters", "parametersSubscribe", "clientPublish",
                                      "services"}));
  for (const char* const topic :
       {"/Drum", "/Axle", "/Stick", "/slewring/transforms", "/slewring/scene", "/slewring/log", "/slewring/session"}) {
    EXPECT_GT(channel_of(received, topic), 0) << topic;
  }
  EXPECT_NE(received.last("advertiseServices"), nullptr);
}

TEST_F(GatewayTest, ASubscriptionReceivesValuesOfTheStepWithItsTime) {
  const ClientId client = connect();
  subscribe(client, 9, channel_of(take_all(client), "/Axle"));
  do_step(5, 12.5);
  const Received received = take_all(client);
  const std::vector<Json> messages = received.messages(9);
  ASSERT_EQ(messages.size(), 1u);
  EXPECT_EQ(messages[0].at("velocity").number(), 12.5);
  // 5 ms behind the subscription
  for (const std::string& binary : received.binaries) {
    if (binary[0] != 1) continue;
    EXPECT_EQ(binary.substr(5, 8), std::string("\x40\x4b\x4c\0\0\0\0\0", 8));
  }
}

TEST_F(GatewayTest, AClientThatDoesNotReadReceivesTheNewestValueAndTheNumberLeftOut) {
  const ClientId slow = connect(), fast = connect();
  subscribe(slow, 1, channel_of(take_all(slow), "/Axle"));
  subscribe(fast, 1, channel_of(take_all(fast), "/Axle"));
  std::size_t of_fast = 0;
  for (StepIndex step = 0; step < 100; ++step) {
    do_step(step, static_cast<double>(step));
    of_fast += take_all(fast).messages(1).size();
  }
  now_ns += 2000 * kMs;
  gateway.poll(view, now_ns);
  EXPECT_EQ(of_fast, 100u);
  const Received received = take_all(slow);
  const std::vector<Json> messages = received.messages(1);
  ASSERT_EQ(messages.size(), 1u);
  EXPECT_EQ(messages[0].at("velocity").number(), 99);
  const Json* const status = received.last("status");
  ASSERT_NE(status, nullptr);
  EXPECT_NE(status->at("message").text().find("were replaced by newer ones"), std::string::npos);
}

TEST_F(GatewayTest, TransformsHaveTheBodysPoseAndTheSceneItsShapes) {
  const ClientId client = connect();
  const Received advertised = take_all(client);
  subscribe(client, 1, channel_of(advertised, "/slewring/transforms"));
  subscribe(client, 2, channel_of(advertised, "/slewring/scene"));
  do_step(0, 0);
  const Received received = take_all(client);
  const std::vector<Json> transforms = received.messages(1), scenes = received.messages(2);
  ASSERT_EQ(transforms.size(), 1u);
  const Json& drum = transforms[0].at("transforms").items().at(1);
  EXPECT_EQ(drum.at("child_frame_id").text(), "Drum");
  EXPECT_EQ(drum.at("translation").at("z").number(), 3);
  EXPECT_EQ(drum.at("rotation").at("w").number(), 1);
  ASSERT_EQ(scenes.size(), 1u);
  EXPECT_EQ(scenes[0].at("entities").items().at(1).at("frame_id").text(), "Drum");
}

TEST_F(GatewayTest, AnEventReachesSubscribersAndThoseThatComeLater) {
  const ClientId first = connect();
  const std::int64_t log = channel_of(take_all(first), "/slewring/log");
  subscribe(first, 1, log);
  take_all(first);
  gateway.add_event(LogLevel::warning, "io", "the lift is loud");
  const ClientId second = connect();
  take_all(second);
  subscribe(second, 1, log);
  for (const ClientId client : {first, second}) {
    const std::vector<Json> events = take_all(client).messages(1);
    ASSERT_FALSE(events.empty());
    EXPECT_EQ(events.back().at("message").text(), "the lift is loud");
    EXPECT_EQ(events.back().at("level").integer(), 3);
  }
}

TEST_F(GatewayTest, APauseIsShownAlthoughNoStepFollows) {
  const ClientId client = connect();
  subscribe(client, 1, channel_of(take_all(client), "/slewring/session"));
  do_step(5, 1);
  EXPECT_FALSE(take_all(client).messages(1).back().at("is_paused").boolean());
  wire::NodeStatus status;
  status.header = header(Role::io, 0, 5);
  status.state = wire::NodeState::holding;
  show(status);
  gateway.poll(view, now_ns);
  const std::vector<Json> messages = take_all(client).messages(1);
  ASSERT_EQ(messages.size(), 1u);
  EXPECT_TRUE(messages[0].at("is_paused").boolean());
}

TEST_F(GatewayTest, AResetGivesANewSessionIdAndKeepsSubscriptions) {
  const ClientId client = connect();
  const Received before = take_all(client);
  subscribe(client, 1, channel_of(before, "/Axle"));
  do_step(500, 1);
  take_all(client);
  do_step(0, 2, 1);
  do_step(1, 3, 1);
  const Received received = take_all(client);
  ASSERT_NE(received.last("serverInfo"), nullptr);
  EXPECT_NE(received.last("serverInfo")->at("sessionId").text(), before.last("serverInfo")->at("sessionId").text());
  const std::vector<Json> messages = received.messages(1);
  ASSERT_FALSE(messages.empty());
  EXPECT_EQ(messages.back().at("velocity").number(), 3);
}

TEST_F(GatewayTest, TenThousandWrongSubscriptionsAreOneStatus) {
  const ClientId client = connect();
  take_all(client);
  std::string text = R"({"op":"subscribe","subscriptions":[)";
  for (int i = 0; i < 10'000; ++i)
    text += (i > 0 ? "," : "") + std::string(R"({"id":)") + std::to_string(i) + R"(,"channelId":90000})";
  give(client, text + "]}");
  const Received received = take_all(client);
  ASSERT_EQ(received.texts.size(), 1u);
  EXPECT_NE(received.texts[0].at("message").text().find("10000 of 10000"), std::string::npos);
}

TEST_F(GatewayTest, AClientWhoseEventsDoNotFitIsToBeClosedAndTheOthersStay) {
  const ClientId client = connect(), other = connect();
  // values of all parameters again and again, without reading one
  for (int i = 0; i < 1000 && gateway.close_reason(client).empty(); ++i)
    give(client, R"({"op":"getParameters","parameterNames":[]})");
  EXPECT_NE(gateway.close_reason(client), "");
  EXPECT_EQ(gateway.close_reason(other), "");
}

TEST_F(GatewayTest, HasRoomForThirtyTwoClients) {
  for (std::size_t i = 0; i < Gateway::kMostClients; ++i) ASSERT_TRUE(gateway.connect());
  EXPECT_FALSE(gateway.connect().has_value());
}

TEST_F(GatewayTest, WithoutRequestsItHasNoCapabilityThatChangesTheSession) {
  GatewayDef looking;
  looking.name = "winch";
  Gateway gateway_that_looks(looking, scene::load_file(SLEWRING_SOURCE_DIR "/scenes/forces/operated.yaml"));
  const ClientId client = *gateway_that_looks.connect();
  const Json info = *Json::parse(gateway_that_looks.next_frame(client)->head);
  EXPECT_EQ(info.at("capabilities").texts(), (std::vector<std::string>{"time", "connectionGraph"}));
  while (gateway_that_looks.next_frame(client)) {
  }
  for (const char* const message :
       {R"({"op":"setParameters","parameters":[{"name":"Drum.mass","value":1}]})",
        R"({"op":"advertise","channels":[{"id":3,"topic":"/inputs/Stick","encoding":"json"}]})"}) {
    gateway_that_looks.take_message(client, FrameType::text, message, 0);
    const auto frame = gateway_that_looks.next_frame(client);
    ASSERT_TRUE(frame.has_value()) << message;
    EXPECT_EQ(Json::parse(frame->head)->at("level").integer(), 2) << message;
  }
}

}  // namespace gateway_test
