// SPDX-License-Identifier: Apache-2.0
#include "devices/canopen_network.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "core/time.h"
#include "devices/field_rules.h"

namespace slew::devices {
namespace {

constexpr std::int64_t kStartIntervalNs = 1'000'000'000;
constexpr double kLeastHeartbeat = 0.005, kMostHeartbeat = 60;  // s
constexpr double kLeastSync = 0.002;                            // s; the device's loop turns once a millisecond

constexpr Field kCanOpenFields[] = {
    field<&CanOpenDef::own_node>(
        "own_node", {.range = {.min = 0, .max = kMaxCanOpenNode, .min_is_open = false, .max_is_open = false},
                     .doc = "canopen: number of the device as a node; 0: it is none"}),
    field<&CanOpenDef::own_heartbeat>(
        "own_heartbeat",
        {.dimension = Dimension::time,
         .range = {.min = kLeastHeartbeat, .max = kMostHeartbeat, .min_is_open = false, .max_is_open = false},
         .doc = "canopen: time between two heartbeats of own_node"}),
    field<&CanOpenDef::sync>("sync",
                             {.dimension = Dimension::time,
                              .range = {.min = 0, .max = kMostHeartbeat, .min_is_open = false, .max_is_open = false},
                              .doc = "canopen: time between two sent SYNC messages, at least 2 ms; 0: none"}),
};

constexpr Field kCanOpenNodeFields[] = {
    field<&CanOpenNodeDef::node>(
        "node", {.range = {.min = 1, .max = kMaxCanOpenNode, .min_is_open = false, .max_is_open = false},
                 .presence = Presence::required,
                 .doc = "number of the node"}),
    field<&CanOpenNodeDef::heartbeat>(
        "heartbeat", {.dimension = Dimension::time,
                      .range = {.min = 0, .max = kMostHeartbeat, .min_is_open = false, .max_is_open = false},
                      .doc = "time without a heartbeat after which the node is missing; 0: it is not watched, its "
                             "values count in any state"}),
    field<&CanOpenNodeDef::is_started>("start", {.doc = "the device starts the node, again after a restart"}),
};

CanFrame frame_of(std::uint32_t id, std::span<const std::byte> bytes) {
  CanFrame frame;
  frame.id = id;
  frame.size = bytes.size();
  std::copy(bytes.begin(), bytes.end(), frame.bytes.begin());
  return frame;
}

CanFrame heartbeat_frame(std::int64_t node, NmtState state) {
  const std::byte byte{static_cast<std::uint8_t>(state)};
  return frame_of(kHeartbeatCobId + static_cast<std::uint32_t>(node), std::span(&byte, 1));
}

}  // namespace

std::span<const Field> canopen_fields() noexcept {
  return kCanOpenFields;
}
std::span<const Field> canopen_node_fields() noexcept {
  return kCanOpenNodeFields;
}

void validate(const std::string& path, const CanOpenDef& def, Problems& problems) {
  check_fields(path, &def, kCanOpenFields, problems);
  if (def.sync > 0 && def.sync < kLeastSync) {
    problems.push_back({path + ".sync", fmt::format("{} s are too short", def.sync), "0, or at least 2 ms", ""});
  }
  for (std::size_t i = 0; i < def.nodes.size(); ++i) {
    const std::string row = fmt::format("{}.nodes[{}]", path, i);
    check_fields(row, &def.nodes[i], kCanOpenNodeFields, problems);
    if (def.nodes[i].node == def.own_node) {
      problems.push_back({row + ".node", fmt::format("{} is the device itself", def.own_node), "another node", ""});
    }
    const auto is_same = [&](const CanOpenNodeDef& other) { return other.node == def.nodes[i].node; };
    if (std::find_if(def.nodes.begin(), def.nodes.end(), is_same) != def.nodes.begin() + static_cast<std::ptrdiff_t>(i))
      problems.push_back(
          {row + ".node", fmt::format("{} is in the list twice", def.nodes[i].node), "each node once", ""});
  }
}

std::string_view text_of(NmtState state) noexcept {
  switch (state) {
    case NmtState::boot_up:
      return "booting";
    case NmtState::stopped:
      return "stopped";
    case NmtState::operational:
      return "operational";
    case NmtState::preoperational:
      break;
  }
  return "pre-operational";
}

std::string text_of(const CanOpenEvent& event) {
  switch (event.kind) {
    case CanOpenEvent::Kind::booted:
      return fmt::format("node {} has restarted: its values from before are void", event.node);
    case CanOpenEvent::Kind::missing:
      return fmt::format(
          "node {} is missing: its heartbeat did not come in time; its values do not count until it is "
          "operational again",
          event.node);
    case CanOpenEvent::Kind::own_changed:
      return fmt::format("this device, node {}, is {}", event.node, text_of(event.state));
    case CanOpenEvent::Kind::own_number_taken:
      return fmt::format(
          "another node sends heartbeats with the number of this device, {}; give one of the two another "
          "number (own_node)",
          event.node);
    case CanOpenEvent::Kind::changed:
      break;
  }
  if (event.state == NmtState::operational) return fmt::format("node {} is operational", event.node);
  return fmt::format("node {} is {}: its values do not count", event.node, text_of(event.state));
}

CanOpenNetwork::CanOpenNetwork(CanOpenDef def) : def_(std::move(def)), nodes_(def_.nodes.size()) {}

bool CanOpenNetwork::is_master() const noexcept {
  return std::any_of(def_.nodes.begin(), def_.nodes.end(), [](const CanOpenNodeDef& node) { return node.is_started; });
}

void CanOpenNetwork::set_own_state(NmtState state) {
  if (own_state_ == state) return;
  own_state_ = state;
  events_.push_back({CanOpenEvent::Kind::own_changed, static_cast<unsigned>(def_.own_node), state});
}

// A master starts itself; another node waits for its master.
void CanOpenNetwork::boot(std::vector<CanFrame>& frames) {
  frames.push_back(heartbeat_frame(def_.own_node, NmtState::boot_up));
  set_own_state(is_master() ? NmtState::operational : NmtState::preoperational);
}

void CanOpenNetwork::connect(std::int64_t now_ns, std::vector<CanFrame>& frames) {
  if (def_.own_node != 0) {
    boot(frames);
    next_heartbeat_ns_ = now_ns + duration_of_seconds(def_.own_heartbeat).ns;
  }
  if (def_.sync > 0) next_sync_ns_ = now_ns + duration_of_seconds(def_.sync).ns;
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    nodes_[i].needs_start = def_.nodes[i].is_started;
    nodes_[i].next_start_ns = now_ns;
  }
  start_nodes(now_ns, frames);
}

// The start of an absent node is not repeated: its boot-up or its first heartbeat comes by itself.
void CanOpenNetwork::start_nodes(std::int64_t now_ns, std::vector<CanFrame>& frames) {
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    CanOpenNode& node = nodes_[i];
    if (!node.needs_start || now_ns < node.next_start_ns) continue;
    frames.push_back(frame_of(kNmtCobId, nmt_frame(NmtCommand::start, static_cast<unsigned>(def_.nodes[i].node))));
    ++node.starts;
    node.next_start_ns = now_ns + kStartIntervalNs;
    if (node.presence != NodePresence::present) node.needs_start = false;
  }
}

void CanOpenNetwork::take(const CanFrame& frame, std::int64_t now_ns, std::vector<CanFrame>& frames) {
  if (frame.is_extended) return;
  if (const auto beat = read_heartbeat(frame.id, frame.data())) return take_heartbeat(*beat, now_ns);
  if (const auto request = read_nmt(frame.id, frame.data())) return take_command(*request, frames);
  if (frame.id == kSyncCobId) ++syncs_;
}

void CanOpenNetwork::take_heartbeat(const Heartbeat& beat, std::int64_t now_ns) {
  if (def_.own_node != 0 && beat.node == static_cast<unsigned>(def_.own_node) && !is_number_taken_) {
    is_number_taken_ = true;
    events_.push_back({CanOpenEvent::Kind::own_number_taken, beat.node, beat.state});
  }
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    if (static_cast<unsigned>(def_.nodes[i].node) != beat.node) continue;
    CanOpenNode& node = nodes_[i];
    const bool was_absent = node.presence != NodePresence::present;
    const bool has_changed = was_absent || node.state != beat.state;
    node.presence = NodePresence::present;
    node.state = beat.state;
    node.heard_ns = now_ns;
    ++node.heartbeats;
    const bool is_booting = beat.state == NmtState::boot_up;
    if (is_booting) ++node.boot_ups;
    if (is_booting || has_changed)
      events_.push_back({is_booting ? CanOpenEvent::Kind::booted : CanOpenEvent::Kind::changed, beat.node, beat.state});
    if (beat.state == NmtState::operational || (beat.state == NmtState::stopped && !was_absent)) {
      node.needs_start = false;
    } else if (def_.nodes[i].is_started && !node.needs_start) {
      node.needs_start = true;
      node.next_start_ns = now_ns;
    } else if (is_booting) {
      node.next_start_ns = now_ns;
    }
  }
}

void CanOpenNetwork::take_command(const NmtRequest& request, std::vector<CanFrame>& frames) {
  if (def_.own_node == 0 || (request.node != 0 && request.node != static_cast<unsigned>(def_.own_node))) return;
  switch (request.command) {
    case NmtCommand::start:
      return set_own_state(NmtState::operational);
    case NmtCommand::stop:
      return set_own_state(NmtState::stopped);
    case NmtCommand::enter_preoperational:
      return set_own_state(NmtState::preoperational);
    case NmtCommand::reset_node:
    case NmtCommand::reset_communication:
      return boot(frames);
  }
}

void CanOpenNetwork::advance(std::int64_t now_ns, std::vector<CanFrame>& frames) {
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    CanOpenNode& node = nodes_[i];
    const CanOpenNodeDef& def = def_.nodes[i];
    if (node.presence != NodePresence::present || def.heartbeat == 0) continue;
    if (now_ns - node.heard_ns <= duration_of_seconds(def.heartbeat).ns) continue;
    node.presence = NodePresence::missing;
    node.needs_start = false;
    ++node.losses;
    events_.push_back({CanOpenEvent::Kind::missing, static_cast<unsigned>(def.node), node.state});
  }
  start_nodes(now_ns, frames);
  if (now_ns >= next_heartbeat_ns_) {
    frames.push_back(heartbeat_frame(def_.own_node, own_state_));
    next_heartbeat_ns_ = now_ns + duration_of_seconds(def_.own_heartbeat).ns;
  }
  if (now_ns >= next_sync_ns_) {
    frames.push_back(frame_of(kSyncCobId, {}));
    ++syncs_;
    // on its grid, without the messages that were missed
    const std::int64_t period_ns = duration_of_seconds(def_.sync).ns;
    next_sync_ns_ += ((now_ns - next_sync_ns_) / period_ns + 1) * period_ns;
  }
}

std::int64_t CanOpenNetwork::due_ns() const noexcept {
  return std::min(next_heartbeat_ns_, next_sync_ns_);
}

bool CanOpenNetwork::is_operational(unsigned node) const noexcept {
  if (def_.own_node != 0 && node == static_cast<unsigned>(def_.own_node)) return own_state_ == NmtState::operational;
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    if (static_cast<unsigned>(def_.nodes[i].node) != node || def_.nodes[i].heartbeat == 0) continue;
    return nodes_[i].presence == NodePresence::present && nodes_[i].state == NmtState::operational;
  }
  return true;
}

std::vector<CanOpenEvent> CanOpenNetwork::take_events() {
  return std::exchange(events_, {});
}

}  // namespace slew::devices
