// SPDX-License-Identifier: Apache-2.0
// A gateway between a session that is played from messages and clients without sockets.
#pragma once

#include <gtest/gtest.h>

#include "build_paths.h"
#include "gateway/gateway.h"
#include "transport/cdr/codec.h"
#include "transport/topics.h"

namespace gateway_test {

using namespace slew;
using namespace slew::gateway;
using wire::Role;

constexpr std::int64_t kMs = 1'000'000;

struct Received {
  std::vector<Json> texts;
  std::vector<std::string> binaries;

  // The last text of an operation; null: none came.
  [[nodiscard]] const Json* last(std::string_view operation) const {
    for (auto text = texts.rbegin(); text != texts.rend(); ++text) {
      if (text->at("op").text() == operation) return &*text;
    }
    return nullptr;
  }
  // Messages of a subscription, from their 14th byte on.
  [[nodiscard]] std::vector<Json> messages(std::uint32_t subscription) const {
    std::vector<Json> found;
    for (const std::string& binary : binaries) {
      if (binary[0] == 1 && static_cast<unsigned char>(binary[1]) == subscription)
        found.push_back(*Json::parse(std::string_view(binary).substr(13)));
    }
    return found;
  }
};

class GatewayTest : public ::testing::Test {
 protected:
  GatewayTest() {
    session_.header = header(Role::io, 0, 0);
    session_.name = "winch";
    session_.step_ns = kMs;
    session_.required_roles = bit(Role::io) | bit(Role::mechanics);
    show(session_);
    wire::VariableDirectory names;
    names.header = header(Role::io, 0, 0);
    names.total = 1;
    names.entries = {{"Stick.raw", "1"}};
    show(names);
    names.header = header(Role::mechanics, 0, 0);
    names.total = 8;
    names.entries.clear();
    for (const char* const name : {"Drum.position.x", "Drum.position.y", "Drum.position.z", "Drum.orientation.w",
                                   "Drum.orientation.x", "Drum.orientation.y", "Drum.orientation.z", "Axle.velocity"}) {
      names.entries.push_back({name, "m"});
    }
    show(names);
    gateway.poll(view, now_ns);
  }

  static GatewayDef def(std::vector<wire::ControlRequest>& requests, std::vector<wire::ControllerInput>& inputs) {
    GatewayDef def;
    def.name = "winch";
    def.session_id = "abc";
    def.controller = "window";
    def.most_event_bytes = 200'000;
    def.send_request = [&requests](wire::ControlRequest request) {
      if (request.request == 0) request.request = 1000 + requests.size();
      requests.push_back(request);
      return request.request;
    };
    def.send_input = [&inputs](const wire::ControllerInput& input) { inputs.push_back(input); };
    return def;
  }

  static wire::Header header(Role role, std::uint32_t epoch, StepIndex step) {
    wire::Header header;
    header.session = {1, 2, 3};
    header.role = role;
    header.epoch = epoch;
    header.phase = wire::Phase::running;
    header.step = step;
    return header;
  }
  template <typename Message>
  void show(const Message& message) {
    transport::ByteBuffer bytes;
    ASSERT_TRUE(transport::encode(message, bytes));
    view.take(transport::kTopicOf<Message>, bytes, std::nullopt, &gateway);
  }
  // One step of both nodes, and the time until the next values may be sent.
  void do_step(StepIndex step, double velocity, std::uint32_t epoch = 0) {
    now_ns += 20 * kMs;
    gateway.poll(view, now_ns);
    wire::VariableBlock block;
    block.header = header(Role::io, epoch, step);
    block.values.push_back(0.25);
    show(block);
    block.header.role = Role::mechanics;
    block.values.clear();
    for (const double value : {1.0, 2.0, 3.0, 1.0, 0.0, 0.0, 0.0, velocity}) block.values.push_back(value);
    show(block);
  }
  ClientId connect() { return *gateway.connect(); }
  void give(ClientId client, const std::string& text) { gateway.take_message(client, FrameType::text, text, now_ns); }
  void call(ClientId client, std::uint32_t service, const std::string& request) {
    std::string bytes = {2};
    for (const std::uint32_t number : {service, 77u, 4u}) {
      for (int i = 0; i < 4; ++i) bytes.push_back(static_cast<char>(number >> (8 * i)));
    }
    gateway.take_message(client, FrameType::binary, bytes + "json" + request, now_ns);
  }
  Received take_all(ClientId client) {
    Received received;
    while (const auto frame = gateway.next_frame(client)) {
      const std::string bytes = frame->head + (frame->body != nullptr ? *frame->body : "");
      if (frame->type == FrameType::text) {
        received.texts.push_back(*Json::parse(bytes));
      } else {
        received.binaries.push_back(bytes);
      }
    }
    return received;
  }
  // Number of the channel of a topic, as it was advertised.
  static std::int64_t channel_of(const Received& received, const std::string& topic) {
    for (const Json& text : received.texts) {
      if (text.at("op").text() != "advertise") continue;
      for (const Json& channel : text.at("channels").items()) {
        if (channel.at("topic").text() == topic) return channel.at("id").integer();
      }
    }
    return -1;
  }
  void subscribe(ClientId client, std::uint32_t subscription, std::int64_t channel) {
    give(client, R"({"op":"subscribe","subscriptions":[{"id":)" + std::to_string(subscription) + R"(,"channelId":)" +
                     std::to_string(channel) + "}]}");
  }
  // The session's reply to the newest request of an action.
  void reply(wire::ControlAction action, bool is_accepted, double value, const std::string& reason = "") {
    for (auto request = requests.rbegin(); request != requests.rend(); ++request) {
      if (request->action != action) continue;
      wire::ControlReply reply;
      reply.header = header(Role::io, 0, 42);
      reply.request = request->request;
      reply.is_accepted = is_accepted;
      reply.value = value;
      reply.reason = reason;
      gateway.take_reply(reply);
      return;
    }
    ADD_FAILURE() << "no request of this action was sent";
  }

  std::int64_t now_ns = kMs;
  std::vector<wire::ControlRequest> requests;
  std::vector<wire::ControllerInput> inputs;
  observer::SessionView view{"winch"};
  wire::SessionDescription session_;
  Gateway gateway{def(requests, inputs), scene::load_file(SLEWRING_SOURCE_DIR "/scenes/forces/operated.yaml")};
};

}  // namespace gateway_test
