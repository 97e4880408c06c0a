// SPDX-License-Identifier: Apache-2.0
// What clients of a gateway change in a session: parameters, services and inputs.
#include "gateway_fixture.h"

namespace gateway_test {

TEST_F(GatewayTest, AParameterIsSetWithTheStepFromWhichItHolds) {
  const ClientId client = connect(), other = connect();
  take_all(client);
  take_all(other);
  give(other, R"({"op":"subscribeParameterUpdates","parameterNames":["Drum.mass"]})");
  give(client, R"({"op":"setParameters","parameters":[{"name":"Drum.mass","value":50}],"id":"s"})");
  EXPECT_EQ(take_all(client).last("parameterValues"), nullptr);
  reply(wire::ControlAction::set_parameter, true, 0);
  for (const ClientId receiver : {client, other}) {
    const Received received = take_all(receiver);
    const Json* const values = received.last("parameterValues");
    ASSERT_NE(values, nullptr);
    const Json& mass = values->at("parameters").items().at(0);
    EXPECT_EQ(mass.at("value").number(), 50);
    EXPECT_EQ(mass.at("step").integer(), 42);
    EXPECT_EQ(mass.at("unit").text(), "kg");
    EXPECT_EQ(mass.at("minimum").number(), 0);
  }
}

TEST_F(GatewayTest, ARefusedParameterKeepsItsValueAndStatesTheReason) {
  const ClientId client = connect();
  take_all(client);
  for (const char* const value : {"-5", R"("1 m")", R"("heavy")"}) {
    give(client, std::string(R"({"op":"setParameters","parameters":[{"name":"Drum.mass","value":)") + value +
                     R"(}],"id":"s"})");
    const Received received = take_all(client);
    ASSERT_NE(received.last("status"), nullptr) << value;
    EXPECT_NE(received.last("status")->at("message").text().find("nothing was changed"), std::string::npos);
    EXPECT_EQ(received.last("parameterValues")->at("parameters").items().at(0).at("value").number(), 40);
  }
  give(client, R"({"op":"setParameters","parameters":[{"name":"Drum.mass","value":50}]})");
  reply(wire::ControlAction::set_parameter, false, 0, "the session is at its end");
  const Received received = take_all(client);
  EXPECT_NE(received.last("status")->at("message").text().find("the session is at its end"), std::string::npos);
  EXPECT_EQ(received.last("parameterValues")->at("parameters").items().at(0).at("value").number(), 40);
}

TEST_F(GatewayTest, AChangeByAnotherProgramIsReadFromTheSession) {
  const ClientId client = connect();
  take_all(client);
  give(client, R"({"op":"subscribeParameterUpdates","parameterNames":[]})");
  // the values of the begin
  for (int round = 0; round < 100; ++round) {
    gateway.poll(view, now_ns);
    const std::size_t count = requests.size();
    for (std::size_t i = 0; i < count; ++i) {
      wire::ControlReply reply;
      reply.request = requests[i].request;
      gateway.take_reply(reply);
    }
  }
  requests.clear();
  wire::ControlReply foreign;
  foreign.header = header(Role::io, 0, 7);
  foreign.request = 5;
  foreign.is_accepted = true;
  foreign.asked = "set Drum.mass to 61";
  gateway.take_reply(foreign);
  gateway.poll(view, now_ns);
  ASSERT_FALSE(requests.empty());
  EXPECT_EQ(requests.back().path, "Drum.mass");
  reply(wire::ControlAction::get_parameter, true, 61);
  const Received received = take_all(client);
  ASSERT_NE(received.last("parameterValues"), nullptr);
  EXPECT_EQ(received.last("parameterValues")->at("parameters").items().at(0).at("value").number(), 61);
}

TEST_F(GatewayTest, AServiceIsAnsweredWhenTheSessionHasAnswered) {
  const ClientId client = connect();
  take_all(client);
  call(client, static_cast<std::uint32_t>(Call::pause), "");
  EXPECT_TRUE(take_all(client).binaries.empty());
  reply(wire::ControlAction::pause, true, 0);
  const Received received = take_all(client);
  ASSERT_EQ(received.binaries.size(), 1u);
  const Json answer = *Json::parse(std::string_view(received.binaries[0]).substr(17));
  EXPECT_TRUE(answer.at("accepted").boolean());
  EXPECT_EQ(answer.at("step").integer(), 42);
}

TEST_F(GatewayTest, AClientThatFillsItsShareOfRequestsLeavesTheOthersTheirs) {
  const ClientId greedy = connect(), other = connect();
  take_all(greedy);
  take_all(other);
  const std::size_t before = requests.size();
  for (int i = 0; i < 300; ++i) call(greedy, static_cast<std::uint32_t>(Call::pause), "");
  EXPECT_EQ(requests.size() - before, Requests::kMostOfOwner);
  const std::vector<std::string> answers = take_all(greedy).binaries;
  ASSERT_EQ(answers.size(), 300 - Requests::kMostOfOwner);
  EXPECT_NE(answers[0].find("of this client wait"), std::string::npos);
  call(other, static_cast<std::uint32_t>(Call::resume), "");
  reply(wire::ControlAction::resume, true, 0);
  const Received received = take_all(other);
  ASSERT_EQ(received.binaries.size(), 1u);
  EXPECT_TRUE(Json::parse(std::string_view(received.binaries[0]).substr(17))->at("accepted").boolean());
}

TEST_F(GatewayTest, WrongCallsFailAndChangeNothing) {
  const ClientId client = connect();
  take_all(client);
  const std::size_t before = requests.size();
  call(client, 999, "{}");
  call(client, static_cast<std::uint32_t>(Call::step), R"({"steps":0})");
  call(client, static_cast<std::uint32_t>(Call::step), R"({"steps":"many"})");
  call(client, static_cast<std::uint32_t>(Call::set_parameter), "{}");
  call(client, static_cast<std::uint32_t>(Call::seek), R"({"time":1})");
  call(client, static_cast<std::uint32_t>(Call::pause), "[1");
  for (const char* const name : {"", "../x", "a/b", "a.b", ".", "a b"})
    call(client, static_cast<std::uint32_t>(Call::save), std::string(R"({"name":")") + name + R"("})");
  const Received received = take_all(client);
  EXPECT_EQ(received.texts.size(), 12u);
  for (const Json& text : received.texts) EXPECT_EQ(text.at("op").text(), "serviceCallFailure");
  EXPECT_EQ(requests.size(), before);
}

TEST_F(GatewayTest, APublishedValueMovesTheInputAndAClosedPageGivesItBack) {
  const ClientId client = connect();
  take_all(client);
  give(client,
       R"({"op":"advertise","channels":[{"id":3,"topic":"/inputs/Stick","encoding":"json","schemaName":"x"}]})");
  const auto publish = [&](const std::string& message) {
    gateway.take_message(client, FrameType::binary, std::string("\1\3\0\0\0", 5) + message, now_ns);
  };
  publish(R"({"value":0.3})");
  ASSERT_EQ(inputs.size(), 1u);
  wire::ControllerLease lease;
  lease.controller = inputs[0].controller;
  lease.channel = "Stick";
  lease.holder = inputs[0].controller;
  lease.is_granted = true;
  lease.answers = inputs[0].sequence;
  gateway.take_lease(lease);
  publish(R"({"value":0.4})");
  ASSERT_EQ(inputs.size(), 2u);
  EXPECT_EQ(inputs[1].value, 0.4);
  for (const char* const wrong : {"0.3", R"({"value":"much"})", "{}", R"({"value":1e999})", ""}) publish(wrong);
  EXPECT_EQ(inputs.size(), 2u);
  EXPECT_NE(take_all(client).last("status"), nullptr);
  gateway.disconnect(client);
  ASSERT_EQ(inputs.size(), 3u);
  EXPECT_EQ(inputs[2].action, wire::ControllerAction::release);
}

}  // namespace gateway_test
