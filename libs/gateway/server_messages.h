// SPDX-License-Identifier: Apache-2.0
// Messages of the Foxglove WebSocket protocol to a client (foxglove-sdk, ws_protocol/server). Texts are JSON; binary
// messages are little-endian behind one byte of opcode.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/json.h"

namespace slew::gateway {

enum class StatusLevel : std::uint8_t { info, warning, error };

// Start and end of a recording.
struct DataRange {
  std::uint64_t from_ns = 0, to_ns = 0;
};

struct ServerInfo {
  std::string name;
  std::vector<std::string> capabilities;
  std::string session_id;            // with a new one clients forget what they have received
  Json metadata = Json::object();    // texts by name
  std::optional<DataRange> range{};  // of a recording
};

// json: the schema is a JSON schema; cdr: it is an interface definition (OMG IDL).
enum class ChannelEncoding : std::uint8_t { json, cdr };

// A channel of the server.
struct ChannelInfo {
  std::uint32_t id = 0;
  std::string topic;
  std::string schema_name;
  std::string schema;
  ChannelEncoding encoding = ChannelEncoding::json;
};

struct ServiceInfo {
  std::uint32_t id = 0;
  std::string name;
  Json request = Json::object();   // JSON schema
  Json response = Json::object();  // JSON schema
};

enum class PlaybackStatus : std::uint8_t { playing, paused, buffering, ended };
struct PlaybackState {
  PlaybackStatus status = PlaybackStatus::paused;
  std::uint64_t time_ns = 0;
  float speed = 1;
  bool did_seek = false;
  std::string request{};  // id of the request that this answers; empty: none
};

[[nodiscard]] std::string to_text(const ServerInfo& info);
// id: a later status of this id replaces it; empty: none.
[[nodiscard]] std::string status_text(StatusLevel level, std::string_view message, std::string_view id = {});
[[nodiscard]] std::string remove_status_text(std::string_view id);
[[nodiscard]] std::string advertise_text(std::span<const ChannelInfo> channels);
[[nodiscard]] std::string unadvertise_text(std::span<const std::uint32_t> ids);
[[nodiscard]] std::string advertise_services_text(std::span<const ServiceInfo> services);
// parameters: an array of {name, value, ...}; id: of the request, empty: none.
[[nodiscard]] std::string parameter_values_text(const Json& parameters, std::string_view id);
[[nodiscard]] std::string service_failure_text(std::uint32_t service, std::uint32_t call, std::string_view message);

// A time as messages in JSON have it: {sec, nsec}.
[[nodiscard]] Json time_json(std::uint64_t ns);

// Head of a message of a channel; the message follows.
[[nodiscard]] std::string message_head(std::uint32_t subscription, std::uint64_t time_ns);
[[nodiscard]] std::string time_bytes(std::uint64_t time_ns);
[[nodiscard]] std::string service_response_bytes(std::uint32_t service, std::uint32_t call, const Json& response);
// Head of an asset; its bytes follow. Or the reason why there is none.
[[nodiscard]] std::string asset_head(std::uint32_t request);
[[nodiscard]] std::string asset_failure_bytes(std::uint32_t request, std::string_view message);
[[nodiscard]] std::string playback_state_bytes(const PlaybackState& state);

}  // namespace slew::gateway
