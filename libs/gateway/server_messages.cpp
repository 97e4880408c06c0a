// SPDX-License-Identifier: Apache-2.0
#include "gateway/server_messages.h"

#include <cstring>
#include <type_traits>

namespace slew::gateway {
namespace {

enum class Opcode : std::uint8_t { message = 1, time = 2, service_response = 3, asset = 4, playback_state = 5 };

constexpr std::uint64_t kSecondNs = 1'000'000'000;

// Little-endian, whatever the machine.
template <typename Unsigned>
void put(std::string& bytes, Unsigned value) {
  static_assert(std::is_unsigned_v<Unsigned>);
  for (std::size_t i = 0; i < sizeof value; ++i) bytes.push_back(static_cast<char>(value >> (8 * i) & 0xFF));
}

void put(std::string& bytes, float value) {
  std::uint32_t bits = 0;
  std::memcpy(&bits, &value, sizeof bits);
  put(bytes, bits);
}

void put(std::string& bytes, std::string_view text) {
  put(bytes, static_cast<std::uint32_t>(text.size()));
  bytes += text;
}

std::string begin(Opcode opcode) {
  return {static_cast<char>(opcode)};
}

Json schema_of(const std::string& name, const Json& schema) {
  return {{"encoding", "json"}, {"schemaName", name}, {"schemaEncoding", "jsonschema"}, {"schema", schema.dump()}};
}

}  // namespace

Json time_json(std::uint64_t ns) {
  return {{"sec", ns / kSecondNs}, {"nsec", ns % kSecondNs}};
}

std::string to_text(const ServerInfo& info) {
  Json json = {{"op", "serverInfo"},
               {"name", info.name},
               {"capabilities", info.capabilities},
               {"supportedEncodings", Json::array({"json"})},
               {"metadata", info.metadata},
               {"sessionId", info.session_id}};
  if (info.range) {
    json["dataStartTime"] = time_json(info.range->from_ns);
    json["dataEndTime"] = time_json(info.range->to_ns);
  }
  return json.dump();
}

std::string status_text(StatusLevel level, std::string_view message, std::string_view id) {
  Json json = {{"op", "status"}, {"level", static_cast<unsigned>(level)}, {"message", message}};
  if (!id.empty()) json["id"] = id;
  return json.dump();
}

std::string remove_status_text(std::string_view id) {
  return Json({{"op", "removeStatus"}, {"statusIds", Json::array({id})}}).dump();
}

std::string advertise_text(std::span<const ChannelInfo> channels) {
  Json list = Json::array();
  for (const ChannelInfo& channel : channels) {
    const bool is_json = channel.encoding == ChannelEncoding::json;
    list.push_back({{"id", channel.id},
                    {"topic", channel.topic},
                    {"encoding", is_json ? "json" : "cdr"},
                    {"schemaName", channel.schema_name},
                    {"schemaEncoding", is_json ? "jsonschema" : "omgidl"},
                    {"schema", channel.schema}});
  }
  return Json({{"op", "advertise"}, {"channels", std::move(list)}}).dump();
}

std::string unadvertise_text(std::span<const std::uint32_t> ids) {
  return Json({{"op", "unadvertise"}, {"channelIds", ids}}).dump();
}

std::string advertise_services_text(std::span<const ServiceInfo> services) {
  Json list = Json::array();
  for (const ServiceInfo& service : services) {
    list.push_back({{"id", service.id},
                    {"name", service.name},
                    {"type", "slewring." + service.name},
                    {"request", schema_of("slewring." + service.name + "_request", service.request)},
                    {"response", schema_of("slewring." + service.name + "_response", service.response)}});
  }
  return Json({{"op", "advertiseServices"}, {"services", std::move(list)}}).dump();
}

std::string parameter_values_text(const Json& parameters, std::string_view id) {
  Json json = {{"op", "parameterValues"}, {"parameters", parameters}};
  if (!id.empty()) json["id"] = id;
  return json.dump();
}

std::string service_failure_text(std::uint32_t service, std::uint32_t call, std::string_view message) {
  return Json({{"op", "serviceCallFailure"}, {"serviceId", service}, {"callId", call}, {"message", message}}).dump();
}

std::string message_head(std::uint32_t subscription, std::uint64_t time_ns) {
  std::string bytes = begin(Opcode::message);
  put(bytes, subscription);
  put(bytes, time_ns);
  return bytes;
}

std::string time_bytes(std::uint64_t time_ns) {
  std::string bytes = begin(Opcode::time);
  put(bytes, time_ns);
  return bytes;
}

std::string service_response_bytes(std::uint32_t service, std::uint32_t call, const Json& response) {
  std::string bytes = begin(Opcode::service_response);
  put(bytes, service);
  put(bytes, call);
  put(bytes, std::string_view("json"));
  bytes += response.dump();
  return bytes;
}

std::string asset_head(std::uint32_t request) {
  std::string bytes = begin(Opcode::asset);
  put(bytes, request);
  bytes.push_back('\0');  // success
  put(bytes, std::string_view());
  return bytes;
}

std::string asset_failure_bytes(std::uint32_t request, std::string_view message) {
  std::string bytes = begin(Opcode::asset);
  put(bytes, request);
  bytes.push_back('\1');
  put(bytes, message);
  return bytes;
}

std::string playback_state_bytes(const PlaybackState& state) {
  std::string bytes = begin(Opcode::playback_state);
  bytes.push_back(static_cast<char>(state.status));
  put(bytes, state.time_ns);
  put(bytes, state.speed);
  bytes.push_back(state.did_seek ? '\1' : '\0');
  put(bytes, std::string_view(state.request));
  return bytes;
}

}  // namespace slew::gateway
