// SPDX-License-Identifier: Apache-2.0
// What comes to the window's port: any request is answered with a file, a WebSocket or a refusal with a reason, and no
// request of another site or without the token reaches values; any messages of a client are acted on or ignored with a
// reason, every answer is a message of the protocol, and no request without one of the client reaches the session.
#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "gateway/client_messages.h"
#include "gateway/door.h"
#include "gateway/gateway.h"
#include "scene/scene.h"
#include "tests/fuzz/bytes.h"

namespace {

using namespace slew;
using gateway::FrameType;

constexpr const char* kScene =
    "bodies:\n"
    "  Drum: {mass: 40 kg, inertia: [0.5, 0.5, 0.8]}\n"
    "joints:\n"
    "  Axle: {type: revolute, body2: Drum}\n"
    "forces:\n"
    "  Motor: {type: point_torque, body: Drum, direction: [0, 0, 1], torque: 20 Nm}\n"
    "inputs:\n"
    "  Stick: {type: analog, primitive: Motor}\n";

std::string_view take_line(std::string_view& text) {
  const std::string_view line = text.substr(0, text.find('\n'));
  text.remove_prefix(std::min(text.size(), line.size() + 1));
  return line;
}

void take_request(std::string_view text) {
  gateway::Request request;
  request.method = take_line(text);
  request.target = take_line(text);
  request.host = take_line(text);
  request.origin = take_line(text);
  request.has_origin = !request.origin.empty();
  request.subprotocols = take_line(text);
  request.is_upgrade = !request.subprotocols.empty();
  const gateway::DoorDef door{{"crane"}, {"https://app.foxglove.dev"}, "0123456789abcdef"};
  const gateway::Verdict verdict = judge(door, request);
  if (verdict.service == gateway::Service::error) {
    fuzz::require(verdict.status >= 400 && verdict.status < 500 && !verdict.text.empty());
    return;
  }
  fuzz::require(!request.has_origin || request.origin.ends_with(request.host) || request.origin == door.origins[0]);
  if (verdict.service == gateway::Service::file) {
    fuzz::require(verdict.path.find("..") == std::string::npos && !verdict.path.empty() && verdict.path[0] != '/');
    fuzz::require(verdict.path.find_first_of("\\%:\0") == std::string::npos);
  } else {
    fuzz::require(request.target.find("token=0123456789abcdef") != std::string_view::npos);
  }
}

// A gateway whose session answers nothing.
struct Session {
  std::size_t requests = 0, inputs = 0;
  gateway::Gateway gateway{def(), scene::load_text(kScene, "fuzz")};

  gateway::GatewayDef def() {
    gateway::GatewayDef def;
    def.name = "fuzz";
    def.session_id = "0";
    def.controller = "window";
    def.most_event_bytes = 1 << 20;
    def.send_request = [this](const wire::ControlRequest& request) {
      fuzz::require(request.path.size() <= gateway::kMaxTextBytes);
      return ++requests;
    };
    def.send_input = [this](const wire::ControllerInput& input) {
      ++inputs;
      fuzz::require(std::isfinite(input.value) && input.channel == "Stick");
    };
    return def;
  }
};

void take_messages(fuzz::Choices choices) {
  static Session session;
  static const observer::SessionView view;
  static std::int64_t now_ns = 0;
  // requests of earlier inputs are given up
  now_ns += 4'000'000'000;
  session.gateway.poll(view, now_ns);
  const auto client = session.gateway.connect();
  fuzz::require(client.has_value());
  std::size_t requests = session.requests;
  while (choices.has_more()) {
    const auto type = choices.byte() % 2 == 0 ? FrameType::text : FrameType::binary;
    const std::size_t fours = choices.byte();
    const std::size_t size = 4 * fours + choices.below(4);
    std::string bytes;
    while (bytes.size() < size && choices.has_more()) bytes.push_back(static_cast<char>(choices.byte()));
    const gateway::DecodedMessage decoded =
        type == FrameType::text ? gateway::decode_text(bytes) : gateway::decode_binary(bytes);
    fuzz::require(decoded.message.has_value() == decoded.problem.empty());
    session.gateway.take_message(*client, type, bytes, now_ns);
    fuzz::require(decoded.message.has_value() || session.requests == requests);
    requests = session.requests;
  }
  while (const auto frame = session.gateway.next_frame(*client)) {
    const std::string bytes = frame->head + (frame->body != nullptr ? *frame->body : "");
    fuzz::require(!bytes.empty());
    if (frame->type == FrameType::text) fuzz::require(Json::parse(bytes).has_value());
  }
  session.gateway.disconnect(*client);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  if (data[0] % 2 == 0) {
    take_request({reinterpret_cast<const char*>(data + 1), size - 1});
  } else {
    take_messages({data + 1, size - 1});
  }
  return 0;
}
