// SPDX-License-Identifier: Apache-2.0
// The messages of clients.
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "gateway/connection_graph.h"
#include "gateway/gateway.h"

namespace slew::gateway {
namespace {

constexpr std::size_t kMostPublished = 256;  // channels of one client
constexpr std::string_view kInputs = "/inputs/";

}  // namespace

void Gateway::take_message(ClientId id, FrameType type, std::string_view bytes, std::int64_t now_ns) {
  const auto found = clients_.find(id);
  if (found == clients_.end()) return;
  Client& client = found->second;
  const DecodedMessage decoded = type == FrameType::text ? decode_text(bytes) : decode_binary(bytes);
  if (!decoded.message) return send_status(client, StatusLevel::error, decoded.problem);
  std::visit([&](const auto& message) { take(id, client, message, now_ns); }, *decoded.message);
}

void Gateway::take(ClientId, Client& client, const Subscribe& message, std::int64_t) {
  std::size_t refused = 0;
  client.subscription.resize(channels_.size());
  for (const Subscribe::Subscription& wanted : message.subscriptions) {
    const auto channel = std::ranges::find(channels_, wanted.channel, [](const Channel& c) { return c.info.id; });
    const auto index = static_cast<std::size_t>(channel - channels_.begin());
    if (channel == channels_.end() || client.subscription[index] || client.channels.contains(wanted.id)) {
      ++refused;
      continue;
    }
    client.subscription[index] = wanted.id;
    client.channels[wanted.id] = index;
    if (channel->kind == Kind::scene) {
      send_scene(client);
    } else if (channel->kind == Kind::log) {
      for (const LogEvent& event : log_.kept())
        push(client, binary_frame(message_head(wanted.id, event.time_ns), event.body));
    } else if (channel->kind == Kind::wire) {
      for (const WireMessage& kept : kept_wire_.of(channel->topic))
        client.wire.push(binary_frame(message_head(wanted.id, kept.time_ns), kept.body));
    } else if (revision_ > 0) {
      client.outbox.mark(state_of(index));
    }
  }
  if (refused == 0) return;
  send_status(client, StatusLevel::error,
              fmt::format("{} of {} subscriptions were ignored: there is no such channel, or the channel or the "
                          "subscription's id is in use already",
                          refused, message.subscriptions.size()));
}

void Gateway::take(ClientId, Client& client, const Unsubscribe& message, std::int64_t) {
  for (const std::uint32_t subscription : message.subscriptions) {
    const auto found = client.channels.find(subscription);
    if (found == client.channels.end()) continue;
    client.subscription[found->second].reset();
    client.outbox.unmark(state_of(found->second));
    client.channels.erase(found);
  }
}

void Gateway::take(ClientId, Client& client, const Advertise& message, std::int64_t) {
  for (const Advertise::Channel& channel : message.channels) {
    std::string problem;
    if (!is_steering()) {
      problem = "this gateway takes no input";
    } else if (channel.encoding != "json") {
      problem = "its encoding is not json";
    } else if (!channel.topic.starts_with(kInputs)) {
      problem = "inputs have topics /inputs/<input>";
    } else if (client.published.size() >= kMostPublished) {
      problem = "a client has at most 256 channels";
    }
    if (problem.empty()) {
      client.published[channel.id] = channel.topic.substr(kInputs.size());
    } else {
      send_status(client, StatusLevel::error,
                  fmt::format("channel '{}' was not accepted: {}", channel.topic.substr(0, kMaxTextBytes), problem));
    }
  }
}

// Inputs that are no longer published are given back.
void Gateway::take(ClientId id, Client& client, const Unadvertise& message, std::int64_t) {
  for (const std::uint32_t channel : message.channels) {
    const auto found = client.published.find(channel);
    if (found == client.published.end()) continue;
    static_cast<void>(inputs_.release(id, found->second));  // nothing to give back is no problem here
    client.published.erase(found);
  }
}

void Gateway::take(ClientId id, Client& client, const Publish& message, std::int64_t now_ns) {
  const auto channel = client.published.find(message.channel);
  std::string problem;
  if (channel == client.published.end()) {
    problem = "a message came on a channel that this client has not advertised, or that was not accepted";
  } else {
    const DecodedObject decoded = decode_object(message.bytes);
    const Json* value = decoded.object ? decoded.object->find("value") : nullptr;
    problem = value == nullptr || !value->is_number()
                  ? "a message on /inputs/" + channel->second + R"( is not of the form {"value": 0.3})"
                  : inputs_.publish(id, channel->second, value->number(), newest_step_, now_ns);
  }
  // one status for all: values come many times a second
  if (!problem.empty()) send_status(client, StatusLevel::error, problem + "; it was ignored", "publish");
}

// ---- parameters

void Gateway::take(ClientId, Client& client, const GetParameters& message, std::int64_t) {
  if (!is_steering()) return send_status(client, StatusLevel::error, "this gateway has no parameters");
  push(client, text_frame(parameter_values_text(parameters_.values(message.names), message.id)));
}

// Each change is answered when the session has answered: with the value from then on, or the present one and a status
// with the reason of the refusal.
void Gateway::take(ClientId id, Client& client, const SetParameters& message, std::int64_t now_ns) {
  if (!is_steering()) return send_status(client, StatusLevel::error, "this gateway changes no parameters");
  for (const SetParameters::Change& change : message.changes) {
    const auto done = [this, id, name = change.name, request = message.id](const std::string& problem, StepIndex) {
      const auto found = clients_.find(id);
      if (found == clients_.end()) return;
      if (!problem.empty()) {
        send_status(found->second, StatusLevel::error, name + ": refused, nothing was changed: " + problem,
                    "parameter " + name);
      }
      push(found->second, text_frame(parameter_values_text(parameters_.values({name}), request)));
    };
    parameters_.set(change.name, change.value, std::nullopt, id, done, now_ns);
  }
}

void Gateway::take(ClientId, Client& client, const FollowParameters& message, std::int64_t) {
  const bool is_wanted = message.wanted == Wanted::yes;
  if (message.names.empty()) {
    client.follows_all = is_wanted;
    if (!is_wanted) client.followed.clear();
  }
  for (const std::string& name : message.names) {
    if (!is_wanted) {
      client.followed.erase(name);
    } else if (client.followed.size() < kMaxListed) {
      client.followed.insert(name);
    }
  }
}

void Gateway::publish_parameter(const std::string& name) {
  for (auto& [id, client] : clients_) {
    if (client.follows_all || client.followed.contains(name))
      push(client, text_frame(parameter_values_text(parameters_.values({name}), "")));
  }
}

// ---- connection graph

void Gateway::take(ClientId, Client& client, const FollowGraph& message, std::int64_t) {
  client.follows_graph = message.wanted == Wanted::yes;
  if (client.follows_graph) push(client, text_frame(graph_text()));
}

std::string Gateway::graph_text() const {
  std::vector<ChannelInfo> infos;
  for (const Channel& channel : channels_) infos.push_back(channel.info);
  return connection_graph_text(
      {.roles = seen_.roles, .channels = infos, .services = services_, .inputs = inputs_.channels()});
}

void Gateway::publish_graph() {
  for (auto& [id, client] : clients_) {
    if (client.follows_graph) push(client, text_frame(graph_text()));
  }
}

// ---- assets

void Gateway::take(ClientId, Client& client, const FetchAsset& message, std::int64_t) {
  const std::shared_ptr<const std::string> found = asset(asset_of_uri(message.uri));
  std::string problem;
  if (found == nullptr) {
    problem = fmt::format("there is no asset '{}'; the models of /slewring/scene name them", message.uri);
  } else if (client.outbox.waiting_bytes() + found->size() > def_.most_event_bytes / 2) {
    // the other half is for what cannot be requested again
    problem = fmt::format(
        "'{}' and what this client has not read yet have more than {} bytes; read first, or take "
        "the asset by HTTP, GET /assets/{}",
        message.uri, def_.most_event_bytes / 2, asset_of_uri(message.uri));
  }
  push(client, problem.empty() ? binary_frame(asset_head(message.request), found)
                               : binary_frame(asset_failure_bytes(message.request, problem)));
}

// ---- playback

void Gateway::take(ClientId, Client& client, const PlaybackControl& message, std::int64_t now_ns) {
  if (def_.playback == nullptr) {
    return send_status(client, StatusLevel::error,
                       "a live session has no playback; pause and resume it by the services of these names");
  }
  client.has_controlled_playback = true;
  const Status status = def_.playback->control(message, now_ns);
  if (!status.is_ok()) send_status(client, StatusLevel::error, status.text);
  PlaybackState state = def_.playback->state(now_ns);
  state.did_seek = status.is_ok() && message.seek_ns.has_value();
  state.request = message.id;
  push(client, binary_frame(playback_state_bytes(state)));
  state.request.clear();
  for (auto& [id, other] : clients_) {
    if (&other != &client && other.has_controlled_playback) push(other, binary_frame(playback_state_bytes(state)));
  }
}

}  // namespace slew::gateway
