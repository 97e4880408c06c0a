// SPDX-License-Identifier: Apache-2.0
#include "device_node/bus_protocol.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "devices/j1939.h"

namespace slew::device_node {
namespace {

constexpr std::int64_t kNodeNoticeNs = 1'000'000'000;
constexpr unsigned kClaimKey = devices::kMaxCanOpenNode + 1;  // of notices of the address

// A listener starts no node, and is none.
devices::CanOpenDef network_of(const scene::CanBusDef& bus, BusPart part) {
  devices::CanOpenDef def = bus.canopen;
  if (part == BusPart::takes_part) return def;
  def.own_node = 0;
  def.sync = 0;
  for (devices::CanOpenNodeDef& node : def.nodes) node.is_started = false;
  return def;
}

std::string_view text_of_node(const devices::CanOpenNode& node) {
  if (node.presence == devices::NodePresence::present) return text_of(node.state);
  return node.presence == devices::NodePresence::awaited ? "awaited" : "missing";
}

std::string_view text_of_phase(devices::ClaimPhase phase) {
  switch (phase) {
    case devices::ClaimPhase::none:
      return "not claimed";
    case devices::ClaimPhase::claiming:
      return "claiming";
    case devices::ClaimPhase::claimed:
      return "claimed";
    case devices::ClaimPhase::lost:
      break;
  }
  return "lost";
}

}  // namespace

BusProtocol::BusProtocol(const scene::CanBusDef& bus, BusPart part) {
  if (bus.protocol == scene::CanProtocol::canopen) {
    network_.emplace(network_of(bus, part));
    for (const devices::PdoDef& pdo : bus.pdos) node_of_.push_back(static_cast<unsigned>(pdo.node));
  }
  if (!bus.unit.claims()) return;
  if (part == BusPart::takes_part) {
    claim_.emplace(bus.unit);
  } else {
    fixed_address_ = static_cast<std::uint8_t>(bus.unit.address);
  }
}

void BusProtocol::connect(std::int64_t now_ns) {
  if (network_) network_->connect(now_ns, frames_);
  if (claim_) claim_->connect(now_ns, frames_);
  take_events();
}

void BusProtocol::take(const CanFrame& frame, std::int64_t now_ns) {
  if (network_) network_->take(frame, now_ns, frames_);
  if (claim_) claim_->take(frame, now_ns, frames_);
  take_events();
}

void BusProtocol::advance(std::int64_t now_ns) {
  if (network_) network_->advance(now_ns, frames_);
  if (claim_) claim_->advance(now_ns, frames_);
  take_events();
  for (auto& [key, notice] : pending_) {
    if (notice.text.empty() || now_ns < notice.earliest_ns) continue;
    notices_.push_back(std::exchange(notice.text, ""));
    notice.earliest_ns = now_ns + kNodeNoticeNs;
  }
}

void BusProtocol::note(unsigned key, std::string text) {
  pending_[key].text = std::move(text);
}

void BusProtocol::take_events() {
  using Kind = devices::CanOpenEvent::Kind;
  if (network_) {
    for (const devices::CanOpenEvent& event : network_->take_events()) {
      note(event.node, text_of(event));
      if (event.kind == Kind::own_number_taken) continue;
      const bool is_operational = (event.kind == Kind::changed || event.kind == Kind::own_changed) &&
                                  event.state == devices::NmtState::operational;
      for (std::size_t i = 0; i < node_of_.size(); ++i) {
        if (node_of_[i] == event.node) changes_.push_back({i, is_operational});
      }
    }
  }
  if (claim_) {
    for (const devices::ClaimEvent& event : claim_->take_events()) note(kClaimKey, text_of(event));
  }
}

std::int64_t BusProtocol::due_ns() const noexcept {
  return std::min(network_ ? network_->due_ns() : INT64_MAX, claim_ ? claim_->due_ns() : INT64_MAX);
}

std::vector<CanFrame> BusProtocol::take_frames() {
  return std::exchange(frames_, {});
}

std::vector<std::string> BusProtocol::take_notices() {
  return std::exchange(notices_, {});
}

std::vector<BusProtocol::NodeChange> BusProtocol::take_changes() {
  return std::exchange(changes_, {});
}

bool BusProtocol::is_operational(std::size_t message) const noexcept {
  return !network_ || network_->is_operational(node_of_[message]);
}

bool BusProtocol::is_of_own_node(std::size_t message) const noexcept {
  return network_ && node_of_[message] == static_cast<unsigned>(network_->def().own_node);
}

bool BusProtocol::is_for_us(const CanFrame& frame) const noexcept {
  if ((!claim_ && !fixed_address_) || !frame.is_extended) return true;
  const std::uint8_t destination = devices::split_j1939(frame.id).destination;
  return destination == devices::kJ1939ToAll || destination == (claim_ ? claim_->address() : *fixed_address_);
}

std::optional<std::uint32_t> BusProtocol::sent_id(std::uint32_t id, bool is_extended) const noexcept {
  if (!claim_ || !is_extended) return id;
  if (claim_->phase() != devices::ClaimPhase::claimed) return std::nullopt;
  devices::J1939Id parts = devices::split_j1939(id);
  parts.source = claim_->address();
  return devices::join_j1939(parts);
}

void BusProtocol::add_counts(Json& json) const {
  if (network_) {
    Json nodes = Json::array();
    for (std::size_t i = 0; i < network_->nodes().size(); ++i) {
      const devices::CanOpenNode& node = network_->nodes()[i];
      nodes.push_back({{"node", network_->def().nodes[i].node},
                       {"state", std::string(text_of_node(node))},
                       {"heartbeats", node.heartbeats},
                       {"boot_ups", node.boot_ups},
                       {"losses", node.losses},
                       {"starts", node.starts}});
    }
    json["nodes"] = nodes;
    json["syncs"] = network_->syncs();
    if (network_->def().own_node != 0) json["own_state"] = std::string(text_of(network_->own_state()));
  }
  if (claim_) {
    json["address"] = {{"phase", std::string(text_of_phase(claim_->phase()))},
                       {"address", claim_->address()},
                       {"name", fmt::format("{:016X}", claim_->name())},
                       {"contests", claim_->contests()}};
  }
}

std::string BusProtocol::text() const {
  std::string text;
  if (network_) {
    for (std::size_t i = 0; i < network_->nodes().size(); ++i)
      text += fmt::format("node {} {}  ", network_->def().nodes[i].node, text_of_node(network_->nodes()[i]));
  }
  return text;
}

}  // namespace slew::device_node
