// SPDX-License-Identifier: Apache-2.0
// The clients, and what waits for each: events, states, messages of the wire.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "gateway/gateway.h"
#include "node/identity.h"
#include "transport/roles.h"

namespace slew::gateway {
namespace {

constexpr std::size_t kAdvertisedAtOnce = 100;  // channels in one message
constexpr std::uint64_t kReportedLeftOut = 10;  // values; one or two are the jitter of any client
constexpr std::int64_t kReportEveryNs = 5'000'000'000;
constexpr const char *kLeftOutId = "left_out", *kWireLeftOutId = "wire_left_out";

}  // namespace

std::string Gateway::server_info() const {
  ServerInfo info;
  info.name = "Slewring: " + def_.name;
  info.capabilities = {"time", "connectionGraph"};
  if (is_steering())
    for (const char* name : {"parameters", "parametersSubscribe", "clientPublish"})
      info.capabilities.emplace_back(name);
  if (!services_.empty()) info.capabilities.emplace_back("services");
  if (!def_.assets.empty()) info.capabilities.emplace_back("assets");
  if (def_.playback != nullptr) info.capabilities.emplace_back("playbackControl");
  // clients forget the time before a reset
  info.session_id = fmt::format("{}-{}", def_.session_id, def_.playback != nullptr ? 0 : epoch_.value_or(0));
  info.metadata = {{"session", def_.name}, {"scene", scene_.name}, {"inputs", "/inputs/<input>"}};
  info.range = def_.range;
  return to_text(info);
}

std::optional<ClientId> Gateway::connect() {
  if (clients_.size() >= kMostClients) return std::nullopt;
  const ClientId id = ++last_client_;
  Client& client = clients_.try_emplace(id, def_.most_event_bytes).first->second;
  push(client, text_frame(server_info()));
  std::vector<ChannelInfo> infos;
  for (const Channel& channel : channels_) infos.push_back(channel.info);
  advertise(client, infos);
  if (!services_.empty()) push(client, text_frame(advertise_services_text(services_)));
  if (revision_ > 0) client.outbox.mark(kTimeState);
  return id;
}

void Gateway::advertise(Client& client, std::span<const ChannelInfo> channels) {
  for (std::size_t first = 0; first < channels.size(); first += kAdvertisedAtOnce) {
    const std::size_t count = std::min(kAdvertisedAtOnce, channels.size() - first);
    push(client, text_frame(advertise_text(channels.subspan(first, count))));
  }
}

void Gateway::disconnect(ClientId client) {
  inputs_.leave(client);
  clients_.erase(client);
}

const std::string& Gateway::close_reason(ClientId client) const {
  static const std::string kGone = "the gateway has closed this client";
  const auto found = clients_.find(client);
  return found == clients_.end() ? kGone : found->second.close_reason;
}

void Gateway::push(Client& client, Frame event) {
  if (client.outbox.push(std::move(event)) || !client.close_reason.empty()) return;
  client.close_reason = fmt::format("more than {} bytes of events wait for this client; read them, or connect again",
                                    def_.most_event_bytes);
}

void Gateway::send_status(Client& client, StatusLevel level, std::string_view message, std::string_view id) {
  push(client, text_frame(status_text(level, message, id)));
}

std::optional<Frame> Gateway::next_frame(ClientId id) {
  const auto found = clients_.find(id);
  if (found == clients_.end()) return std::nullopt;
  Client& client = found->second;
  client.is_wire_next = !client.is_wire_next;
  if (client.is_wire_next) {
    if (auto message = client.wire.next()) return message;
  }
  if (auto frame = next_state(client)) return frame;
  return client.wire.next();
}

// Its next event, or else the next state's newest value.
std::optional<Frame> Gateway::next_state(Client& client) {
  while (true) {
    Outbox::Next next = client.outbox.next();
    if (auto* const event = std::get_if<Frame>(&next)) return std::move(*event);
    const auto* const state = std::get_if<std::size_t>(&next);
    if (state == nullptr) return std::nullopt;
    if (*state == kTimeState) return binary_frame(time_bytes(time_ns_));
    const std::size_t channel = *state - state_of(0);
    if (const std::optional<std::uint32_t> subscription = client.subscription_to(channel))
      return binary_frame(message_head(*subscription, values_ns_), body_of(channels_[channel]));
  }
}

std::shared_ptr<const std::string> Gateway::asset(std::string_view name) const {
  const auto found = def_.assets.find(name);
  return found == def_.assets.end() ? nullptr : found->second;
}

std::shared_ptr<const std::string> Gateway::body_of(Channel& channel) {
  if (channel.revision == revision_ && channel.body != nullptr) return channel.body;
  std::string body;
  if (channel.kind == Kind::transforms) {
    frames_.encode_transforms(snapshot_, values_ns_, body);
  } else if (channel.kind == Kind::session) {
    body = session_body();
  } else {
    channel.signal.encode(snapshot_, body);
  }
  channel.revision = revision_;
  channel.body = std::make_shared<const std::string>(std::move(body));
  return channel.body;
}

std::string Gateway::session_body() const {
  Json nodes = Json::array();
  for (const wire::Role role : transport::node_roles()) {
    const observer::NodeView& node = view_->node(role);
    if (!node.is_known) continue;
    nodes.push_back({{"role", node::to_text(role)},
                     {"state", node::to_text(node.status.state)},
                     {"overruns", node.health.overruns},
                     {"refused", node.health.refused_messages}});
  }
  Json holders = Json::object();
  for (const auto& [input, holder] : seen_.holders) holders[input] = holder;
  return Json({{"step", snapshot_.step()},
               {"time", static_cast<double>(time_ns_) * 1e-9},
               {"is_paused", seen_.is_paused},
               {"clients", clients_.size()},
               {"holders", std::move(holders)},
               {"nodes", std::move(nodes)}})
      .dump();
}

void Gateway::send_scene(Client& client) {
  const std::optional<std::uint32_t> subscription = client.subscription_to(kSceneChannel);
  if (!subscription || revision_ == 0) return;
  push(client, binary_frame(message_head(*subscription, time_ns_),
                            std::make_shared<const std::string>(frames_.scene_update(snapshot_, time_ns_))));
}

void Gateway::mark_states(Client& client) {
  client.outbox.mark(kTimeState);
  for (const auto& [subscription, channel] : client.channels) {
    const Kind kind = channels_[channel].kind;
    if (kind != Kind::scene && kind != Kind::log && kind != Kind::wire) client.outbox.mark(state_of(channel));
  }
}

void Gateway::take_wire(wire::Topic topic, std::span<const std::byte> bytes, double time) {
  const auto channel =
      std::ranges::find_if(channels_, [&](const Channel& one) { return one.kind == Kind::wire && one.topic == topic; });
  if (channel == channels_.end()) return;
  const auto index = static_cast<std::size_t>(channel - channels_.begin());
  WireMessage message{time_ns_of(time)};
  const auto body = [&] {
    if (message.body == nullptr) {
      message.body = std::make_shared<const std::string>(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    }
    return message.body;
  };
  if (KeptWireMessages::keeps(topic)) {
    static_cast<void>(body());
    kept_wire_.take(topic, message);
  }
  for (auto& [id, client] : clients_) {
    if (const std::optional<std::uint32_t> subscription = client.subscription_to(index))
      client.wire.push(binary_frame(message_head(*subscription, message.time_ns), body()));
  }
}

bool Gateway::wants_wire() const noexcept {
  return std::ranges::any_of(clients_, [&](const auto& entry) {
    return std::ranges::any_of(entry.second.channels,
                               [&](const auto& channel) { return channels_[channel.second].kind == Kind::wire; });
  });
}

void Gateway::report_left_out(std::int64_t now_ns) {
  for (auto& [id, client] : clients_) {
    client.left_out += client.outbox.take_left_out();
    client.wire_left_out += client.wire.take_left_out();
    if (now_ns >= client.next_wire_report_ns && client.wire_left_out > client.reported_wire_left_out) {
      client.next_wire_report_ns = now_ns + kReportEveryNs;
      client.reported_wire_left_out = client.wire_left_out;
      send_status(client, StatusLevel::warning,
                  fmt::format("this client reads more slowly than messages of the wire come: {} were left out; "
                              "subscribe to fewer topics",
                              client.wire_left_out),
                  kWireLeftOutId);
    }
    if (now_ns < client.next_report_ns || client.left_out - client.reported_left_out < kReportedLeftOut) continue;
    client.next_report_ns = now_ns + kReportEveryNs;
    client.reported_left_out = client.left_out;
    send_status(client, StatusLevel::warning,
                fmt::format("this client reads more slowly than values come: {} values were replaced by newer ones "
                            "before they were sent; subscribe to fewer channels",
                            client.left_out),
                kLeftOutId);
  }
}

}  // namespace slew::gateway
