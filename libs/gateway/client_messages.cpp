// SPDX-License-Identifier: Apache-2.0
#include "gateway/client_messages.h"

#include <cstring>
#include <limits>

#include "core/failure.h"

namespace slew::gateway {
namespace {

constexpr std::size_t kMaxProblem = 300;  // bytes

enum class ClientOpcode : std::uint8_t { publish = 1, service_call = 2, playback_control = 3 };

[[noreturn]] void refuse(const std::string& problem) {
  throw Failure(ExitCode::bad_input, problem);
}

bool is_too_deep(std::string_view text, int deepest) noexcept {
  int depth = 0;
  bool is_in_text = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (is_in_text) {
      if (c == '\\') {
        ++i;
      } else if (c == '"') {
        is_in_text = false;
      }
    } else if (c == '"') {
      is_in_text = true;
    } else if (c == '[' || c == '{') {
      if (++depth > deepest) return true;
    } else if (c == ']' || c == '}') {
      --depth;
    }
  }
  return false;
}

std::uint32_t id_of(const Json& json) {
  const std::int64_t number = json.integer();
  if (number < 0 || number > std::numeric_limits<std::uint32_t>::max()) refuse("an id is not from 0 to 4294967295");
  return static_cast<std::uint32_t>(number);
}

std::string short_text(const std::string& text) {
  if (text.size() > kMaxTextBytes) refuse("a text has more than 1024 bytes");
  return text;
}

std::string id_text(const Json& json) {
  return short_text(json.text_or("id", ""));
}

const std::vector<Json>& list_of(const Json& json, std::string_view name) {
  const Json& list = json.at(name);
  if (!list.is_array()) refuse("'" + std::string(name) + "' is no list");
  if (list.items().size() > kMaxListed) refuse("'" + std::string(name) + "' has more than 16384 entries");
  return list.items();
}

std::vector<std::uint32_t> ids_of(const Json& json, std::string_view name) {
  std::vector<std::uint32_t> ids;
  for (const Json& id : list_of(json, name)) ids.push_back(id_of(id));
  return ids;
}

std::vector<std::string> names_of(const Json& json) {
  std::vector<std::string> names;
  for (const Json& name : list_of(json, "parameterNames")) names.push_back(short_text(name.text()));
  return names;
}

Subscribe subscribe_of(const Json& json) {
  Subscribe message;
  for (const Json& entry : list_of(json, "subscriptions"))
    message.subscriptions.push_back({id_of(entry.at("id")), id_of(entry.at("channelId"))});
  return message;
}

Advertise advertise_of(const Json& json) {
  Advertise message;
  for (const Json& entry : list_of(json, "channels")) {
    message.channels.push_back(
        {id_of(entry.at("id")), short_text(entry.at("topic").text()), short_text(entry.at("encoding").text())});
  }
  return message;
}

SetParameters set_parameters_of(const Json& json) {
  SetParameters message;
  for (const Json& entry : list_of(json, "parameters")) {
    SetParameters::Change& change = message.changes.emplace_back();
    change.name = short_text(entry.at("name").text());
    const Json& value = entry.at("value");
    if (value.is_number()) {
      change.value = value.number();
    } else {
      change.value = short_text(value.text());
    }
  }
  message.id = id_text(json);
  return message;
}

ClientMessage message_of(const Json& json) {
  const std::string operation = short_text(json.at("op").text());
  if (operation == "subscribe") return subscribe_of(json);
  if (operation == "unsubscribe") return Unsubscribe{ids_of(json, "subscriptionIds")};
  if (operation == "advertise") return advertise_of(json);
  if (operation == "unadvertise") return Unadvertise{ids_of(json, "channelIds")};
  if (operation == "getParameters") return GetParameters{names_of(json), id_text(json)};
  if (operation == "setParameters") return set_parameters_of(json);
  if (operation == "subscribeParameterUpdates") return FollowParameters{names_of(json), Wanted::yes};
  if (operation == "unsubscribeParameterUpdates") return FollowParameters{names_of(json), Wanted::no};
  if (operation == "subscribeConnectionGraph") return FollowGraph{Wanted::yes};
  if (operation == "unsubscribeConnectionGraph") return FollowGraph{Wanted::no};
  if (operation == "fetchAsset") return FetchAsset{short_text(json.at("uri").text()), id_of(json.at("requestId"))};
  refuse("this server does not support '" + operation + "'; serverInfo lists its capabilities");
}

// Reads little-endian fields; refuses to read beyond the end.
class Fields {
 public:
  explicit Fields(std::string_view bytes) : rest_(bytes) {}
  template <typename Unsigned>
  [[nodiscard]] Unsigned number() {
    Unsigned value = 0;
    const std::string_view bytes = take(sizeof value);
    for (std::size_t i = 0; i < sizeof value; ++i)
      value = static_cast<Unsigned>(value | static_cast<Unsigned>(static_cast<unsigned char>(bytes[i])) << (8 * i));
    return value;
  }
  [[nodiscard]] float real() {
    const auto bits = number<std::uint32_t>();
    float value = 0;
    std::memcpy(&value, &bits, sizeof value);
    return value;
  }
  [[nodiscard]] std::string text() {
    const auto size = number<std::uint32_t>();
    return short_text(std::string(take(size)));
  }
  [[nodiscard]] std::string_view rest() const noexcept { return rest_; }

 private:
  std::string_view take(std::size_t size) {
    if (size > rest_.size()) refuse("the binary message is too short");
    const std::string_view taken = rest_.substr(0, size);
    rest_.remove_prefix(size);
    return taken;
  }
  std::string_view rest_;
};

PlaybackControl playback_control_of(Fields& fields) {
  PlaybackControl message;
  const auto command = fields.number<std::uint8_t>();
  if (command > 1) refuse("a playback command is 0 (play) or 1 (pause)");
  message.is_paused = command == 1;
  message.speed = fields.real();
  const bool has_seek = fields.number<std::uint8_t>() != 0;
  const auto seek_ns = fields.number<std::uint64_t>();
  if (has_seek) message.seek_ns = seek_ns;
  message.id = fields.text();
  return message;
}

ClientMessage message_of(std::string_view bytes) {
  Fields fields(bytes);
  switch (static_cast<ClientOpcode>(fields.number<std::uint8_t>())) {
    case ClientOpcode::publish: {
      const auto channel = fields.number<std::uint32_t>();
      return Publish{channel, fields.rest()};
    }
    case ClientOpcode::service_call: {
      ServiceCall message;
      message.service = fields.number<std::uint32_t>();
      message.call = fields.number<std::uint32_t>();
      message.encoding = fields.text();
      message.bytes = fields.rest();
      return message;
    }
    case ClientOpcode::playback_control:
      return playback_control_of(fields);
  }
  refuse("the opcode of the binary message is not one of this server's");
}

// A problem may show the client's own text.
DecodedMessage ignored(const std::string& problem) {
  return {std::nullopt, problem.substr(0, kMaxProblem) + "; the message was ignored"};
}

}  // namespace

DecodedObject decode_object(std::string_view text, int deepest) {
  if (text.empty()) return {Json::object(), ""};
  if (is_too_deep(text, deepest))
    return {std::nullopt, "the JSON text is nested deeper than " + std::to_string(deepest) + " levels"};
  std::optional<Json> json = Json::parse(text);
  if (!json || !json->is_object()) return {std::nullopt, "the text is no JSON object"};
  return {std::move(json), ""};
}

DecodedMessage decode_text(std::string_view text) {
  try {
    const DecodedObject decoded = decode_object(text);
    if (!decoded.object) return ignored(decoded.problem);
    return {message_of(*decoded.object), ""};
  } catch (const Failure& failure) {
    return ignored(failure.what());
  }
}

DecodedMessage decode_binary(std::string_view bytes) {
  try {
    return {message_of(bytes), ""};
  } catch (const Failure& failure) {
    return ignored(failure.what());
  }
}

}  // namespace slew::gateway
