// SPDX-License-Identifier: Apache-2.0
// Messages of the Foxglove WebSocket protocol from a client (foxglove-sdk, ws_protocol/client), read strictly: any
// bytes are one message, or a sentence that states the problem.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "core/json.h"

namespace slew::gateway {

inline constexpr std::size_t kMaxMessageBytes = 1 << 20;  // of a client's message
inline constexpr std::size_t kMaxListed = 16'384;         // subscriptions, names or channels in one message
inline constexpr std::size_t kMaxTextBytes = 1024;        // names, topics and ids
inline constexpr int kDeepestMessage = 16;  // levels; the JSON library's memory for one grows with its depth

struct Subscribe {
  struct Subscription {
    std::uint32_t id = 0;  // chosen by the client
    std::uint32_t channel = 0;
  };
  std::vector<Subscription> subscriptions;
};
struct Unsubscribe {
  std::vector<std::uint32_t> subscriptions;
};

// The client will publish on these.
struct Advertise {
  struct Channel {
    std::uint32_t id = 0;  // chosen by the client
    std::string topic;
    std::string encoding;
  };
  std::vector<Channel> channels;
};
struct Unadvertise {
  std::vector<std::uint32_t> channels;
};
struct Publish {
  std::uint32_t channel = 0;
  std::string_view bytes;  // valid as long as the message
};

struct GetParameters {
  std::vector<std::string> names;  // empty: all
  std::string id{};
};
struct SetParameters {
  struct Change {
    std::string name;
    std::variant<double, std::string> value;
  };
  std::vector<Change> changes;
  std::string id{};
};
enum class Wanted : bool { no, yes };
struct FollowParameters {
  std::vector<std::string> names;  // empty: all
  Wanted wanted = Wanted::yes;
};

struct ServiceCall {
  std::uint32_t service = 0;
  std::uint32_t call = 0;
  std::string encoding;
  std::string_view bytes;  // valid as long as the message
};

struct FollowGraph {
  Wanted wanted = Wanted::yes;
};

// The answer is one message: for a client's own number of the request.
struct FetchAsset {
  std::string uri;
  std::uint32_t request = 0;
};

struct PlaybackControl {
  bool is_paused = false;
  float speed = 1;
  std::optional<std::uint64_t> seek_ns{};
  std::string id{};
};

using ClientMessage =
    std::variant<Subscribe, Unsubscribe, Advertise, Unadvertise, Publish, GetParameters, SetParameters,
                 FollowParameters, ServiceCall, FollowGraph, FetchAsset, PlaybackControl>;

struct DecodedMessage {
  std::optional<ClientMessage> message{};
  std::string problem{};  // when there is no message
};

[[nodiscard]] DecodedMessage decode_text(std::string_view text);
[[nodiscard]] DecodedMessage decode_binary(std::string_view bytes);

// A JSON object, such as that of a service call; an empty text is an empty object. None, with the problem, for other
// texts, and for one that is nested deeper.
struct DecodedObject {
  std::optional<Json> object{};
  std::string problem{};
};
[[nodiscard]] DecodedObject decode_object(std::string_view text, int deepest = kDeepestMessage);

}  // namespace slew::gateway
