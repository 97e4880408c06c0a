// SPDX-License-Identifier: Apache-2.0
#include "gateway/gateway.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "gateway/foxglove_schemas.h"
#include "node/identity.h"
#include "transport/roles.h"

namespace slew::gateway {
namespace {

constexpr std::int64_t kOneSecondNs = 1'000'000'000;
constexpr std::int64_t kFrameNs = kOneSecondNs / 60;
constexpr std::int64_t kStandstillNs = 250'000'000;      // no whole step for so long: the newest values are shown
constexpr std::int64_t kDirectoryNs = 5 * kOneSecondNs;  // longest wait for the names of all variables

std::vector<InputChannel> inputs_of(const scene::Scene& scene) {
  std::vector<InputChannel> channels;
  for (const scene::InputDef& input : scene.inputs) {
    channels.push_back(
        {input.name, input.type == scene::InputType::digital, input.controller == scene::ControllerMode::lockstep});
  }
  return channels;
}

std::string session_schema() {
  const Json number = {{"type", "number"}}, text = {{"type", "string"}}, truth = {{"type", "boolean"}};
  const Json node = {{"type", "object"},
                     {"properties", {{"role", text}, {"state", text}, {"overruns", number}, {"refused", number}}}};
  return Json({{"title", "slewring.Session"},
               {"type", "object"},
               {"properties",
                {{"step", number},
                 {"time", number},
                 {"is_paused", truth},
                 {"clients", number},
                 {"holders", {{"type", "object"}, {"properties", Json::object()}}},
                 {"nodes", {{"type", "array"}, {"items", node}}}}}})
      .dump();
}

}  // namespace

Gateway::Gateway(GatewayDef def, scene::Scene scene)
    : def_(std::move(def)),
      scene_(std::move(scene)),
      frames_(scene_, def_.assets),
      requests_(def_.send_request),
      parameters_(scene_, requests_, [this](const std::string& name) { publish_parameter(name); }),
      inputs_(inputs_of(scene_), def_.controller, def_.send_input),
      services_(service_infos(calls())) {
  const auto add = [&](Kind kind, const char* topic, const char* schema_name, std::string schema) {
    Channel& channel = channels_.emplace_back();
    channel.info = {++last_channel_, topic, schema_name, std::move(schema)};
    channel.kind = kind;
  };
  add(Kind::transforms, "/slewring/transforms", "foxglove.FrameTransforms", frame_transforms_schema());
  add(Kind::scene, "/slewring/scene", "foxglove.SceneUpdate", scene_update_schema());
  add(Kind::log, "/slewring/log", "foxglove.Log", log_schema());
  add(Kind::session, "/slewring/session", "slewring.Session", session_schema());
  for (const WireChannelDef& wire : def_.wire) {
    Channel& channel = channels_.emplace_back();
    channel.info = channel_info(wire, ++last_channel_);
    channel.kind = Kind::wire;
    channel.topic = wire.topic;
  }
}

std::span<const Call> Gateway::calls() const noexcept {
  if (def_.playback != nullptr) return def_.continuation != nullptr ? continued_calls() : recording_calls();
  return is_steering() ? session_calls() : std::span<const Call>();
}

// ---- the session

void Gateway::take_block(const wire::VariableBlock& block, std::span<const std::byte>, double time) {
  newest_block_ns_ = time_ns_of(time);
  if (block.header.epoch != epoch_) begin_epoch(block.header.epoch);
  newest_step_ = std::max(newest_step_, block.header.step);
  const bool is_whole = snapshot_.take(block);
  if (!is_whole || def_.playback != nullptr || view_ == nullptr || built_places_ == 0) return;
  publish_step(*view_);
}

void Gateway::begin_epoch(std::uint32_t epoch) {
  const bool is_reset = epoch_.has_value() && def_.playback == nullptr;
  epoch_ = epoch;
  newest_step_ = kJoinStep;
  snapshot_.forget_values();
  inputs_.take_epoch(epoch);
  if (!is_reset) return;
  seen_.holders.clear();
  parameters_.refresh();
  for (auto& [id, client] : clients_) {
    push(client, text_frame(server_info()));
    send_scene(client);
  }
  add_event(LogLevel::info, "io", "the session began again");
}

void Gateway::take_lease(const wire::ControllerLease& lease) {
  inputs_.take(lease);
  std::string& holder = seen_.holders[lease.channel];
  if (holder == lease.holder) return;
  holder = lease.holder;
  seen_.has_changed = true;
  add_event(LogLevel::info, "io",
            lease.holder.empty()
                ? "input " + lease.channel + " is free" + (lease.reason.empty() ? "" : ": " + lease.reason)
                : "'" + lease.holder + "' holds input " + lease.channel);
}

void Gateway::take_reply(const wire::ControlReply& reply) {
  if (!requests_.take(reply)) parameters_.take(reply);
  if (reply.asked.empty() || reply.asked.starts_with("get ")) return;
  add_event(reply.is_accepted ? LogLevel::info : LogLevel::warning, "io",
            reply.is_accepted ? fmt::format("{}, from step {} on", reply.asked, reply.header.step)
                              : fmt::format("{}: refused: {}", reply.asked, reply.reason));
}

void Gateway::add_event(LogLevel level, const std::string& source, const std::string& text) {
  const LogEvent& event = log_.add(time_ns_, level, source, text);
  for (auto& [id, client] : clients_) {
    if (const std::optional<std::uint32_t> subscription = client.subscription_to(kLogChannel))
      push(client, binary_frame(message_head(*subscription, event.time_ns), event.body));
  }
}

// Replaces the channels of signals: a name that comes later may belong to an element that has a channel already.
void Gateway::build_channels(const observer::SessionView& view) {
  std::vector<NamedPlace> variables;
  std::array<std::size_t, wire::kRoles> totals{};
  for (const observer::VariablePlace& place : view.places()) {
    const observer::VariableView& variable = view.variable(place);
    variables.push_back({variable.name, variable.unit, place});
    std::size_t& total = totals[static_cast<std::size_t>(place.role)];
    total = std::max<std::size_t>(total, place.index + 1);
  }
  std::ranges::stable_sort(variables, {}, &NamedPlace::place);
  for (std::size_t role = 0; role < totals.size(); ++role)
    snapshot_.set_total(static_cast<wire::Role>(role), totals[role]);
  built_places_ = view.places().size();
  frames_.find_places(view);

  std::vector<std::uint32_t> old;
  const auto first_signal = std::ranges::find(channels_, Kind::signal, &Channel::kind);
  const auto kept = static_cast<std::size_t>(first_signal - channels_.begin());
  for (auto channel = first_signal; channel != channels_.end(); ++channel) old.push_back(channel->info.id);
  channels_.resize(kept);
  std::vector<ChannelInfo> infos;
  for (SignalChannel& signal : signal_channels(variables)) {
    Channel& channel = channels_.emplace_back();
    channel.info = {++last_channel_, signal.topic, signal.schema_name, signal.schema};
    channel.signal = std::move(signal);
    infos.push_back(channel.info);
  }
  for (auto& [id, client] : clients_) {
    client.outbox.forget_states();
    std::erase_if(client.channels, [&](const auto& entry) { return entry.second >= kept; });
    client.subscription.resize(std::min(client.subscription.size(), kept));
    if (!old.empty()) push(client, text_frame(unadvertise_text(old)));
    advertise(client, infos);
  }
  publish_graph();
}

void Gateway::publish(std::uint64_t time_ns, std::uint64_t values_ns) {
  time_ns_ = time_ns;
  values_ns_ = values_ns;
  const bool is_first = revision_ == 0;
  ++revision_;
  for (auto& [id, client] : clients_) {
    mark_states(client);
    if (is_first) send_scene(client);
  }
}

void Gateway::publish_step(const observer::SessionView& view) {
  const auto time_ns = static_cast<std::uint64_t>(start_of(snapshot_.step(), {view.session().step_ns}).ns);
  publish(time_ns, time_ns);
}

void Gateway::show(const observer::SessionView& view, std::uint64_t time_ns) {
  publish(time_ns, snapshot_.take(view) ? newest_block_ns_ : time_ns);
}

void Gateway::publish_playback(std::int64_t now_ns) {
  const std::string bytes = playback_state_bytes(def_.playback->state(now_ns));
  for (auto& [id, client] : clients_) {
    if (client.has_controlled_playback) push(client, binary_frame(bytes));
  }
}

void Gateway::forget_values() {
  snapshot_.forget_values();
  seen_.is_other_time = revision_ > 0;
}

void Gateway::watch_nodes(const observer::SessionView& view) {
  const bool is_other_time = std::exchange(seen_.is_other_time, false);
  if (const bool is_paused = view.is_paused(); is_paused != std::exchange(seen_.is_paused, is_paused)) {
    seen_.has_changed = true;
    if (!is_other_time) add_event(LogLevel::info, "io", is_paused ? "the session is paused" : "the session goes on");
  }
  std::uint32_t roles = 0;
  for (const wire::Role role : transport::node_roles()) roles |= view.node(role).is_known ? bit(role) : 0;
  if (roles != std::exchange(seen_.roles, roles)) publish_graph();
  for (const wire::Role role : transport::node_roles()) {
    const observer::NodeView& node = view.node(role);
    wire::NodeState& state = seen_.states[static_cast<std::size_t>(role)];
    if (!node.is_known || node.status.state == state) continue;
    state = node.status.state;
    seen_.has_changed = true;
    if (is_other_time) continue;
    const bool is_bad = state == wire::NodeState::fault || (state == wire::NodeState::holding && !seen_.is_paused);
    add_event(is_bad ? LogLevel::warning : LogLevel::info, std::string(node::to_text(role)),
              fmt::format("{}{}{}", node::to_text(state), node.status.reason.empty() ? "" : ": ", node.status.reason));
  }
}

void Gateway::poll(const observer::SessionView& view, std::int64_t now_ns) {
  view_ = &view;
  if (times_.first_poll_ns == 0) times_.first_poll_ns = now_ns;
  const bool has_names =
      def_.playback != nullptr || view.has_whole_directory() || now_ns - times_.first_poll_ns > kDirectoryNs;
  if (has_names && view.places().size() != built_places_) build_channels(view);
  watch_nodes(view);
  if (def_.playback == nullptr) {
    if (now_ns >= times_.next_request_ns && !snapshot_.is_requested()) {
      snapshot_.request();
      times_.requested_ns = now_ns;
      times_.next_request_ns = std::max(times_.next_request_ns + kFrameNs, now_ns);
    }
    const StepIndex shown = snapshot_.step();
    const bool stands = snapshot_.is_requested() && now_ns - times_.requested_ns > kStandstillNs;
    if (stands && built_places_ > 0 && snapshot_.take(view) && snapshot_.step() != shown) publish_step(view);
  }
  // a session that stands publishes no step that would bring them
  if (std::exchange(seen_.has_changed, false) && revision_ > 0) publish(time_ns_, values_ns_);
  if (is_steering()) {
    requests_.poll(now_ns);
    parameters_.poll(now_ns);
    inputs_.poll(now_ns, [this](ClientId id, const std::string& input) {
      const auto found = clients_.find(id);
      if (found == clients_.end()) return;
      send_status(found->second, StatusLevel::warning,
                  "no value for input " + input + " came for 150 ms; it was put to neutral", "silent " + input);
    });
  }
  if (now_ns < times_.next_second_ns) return;
  times_.next_second_ns = now_ns + kOneSecondNs;
  report_left_out(now_ns);
}

void Gateway::end(const std::string& reason) {
  inputs_.leave_all();
  for (auto& [id, client] : clients_) {
    send_status(client, StatusLevel::info, reason);
    if (client.close_reason.empty()) client.close_reason = reason;
  }
}

}  // namespace slew::gateway
