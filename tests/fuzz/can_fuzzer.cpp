// SPDX-License-Identifier: Apache-2.0
// Frames of a CAN bus for the state machines of its protocols: a CANopen network and an address claim of J1939.
// Any frames at any times: a node counts as operational only on its word and for its time; what is sent is addressed to
// nodes of the definition, has the device's own number or NAME, and is bounded by what has come; a claimed address is
// never sent from before its time, nor after its loss.
#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "devices/canopen_network.h"
#include "devices/j1939.h"
#include "devices/j1939_claim.h"
#include "tests/fuzz/bytes.h"

namespace {

using namespace slew;
using namespace slew::devices;

constexpr int kMostSteps = 400;
constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kContestNs = 250 * kMs;

// Mostly frames that the machines read.
CanFrame frame_of(fuzz::Choices& choices, std::uint64_t name) {
  CanFrame frame;
  const std::size_t kind = choices.below(8);
  const auto source = static_cast<std::uint32_t>(choices.byte());
  frame.size = choices.below(9);
  if (kind == 0) {
    frame.id = kNmtCobId, frame.size = 2;
  } else if (kind == 1) {
    frame.id = kSyncCobId, frame.size = 0;
  } else if (kind <= 3) {
    frame.id = kHeartbeatCobId + source % 8, frame.size = 1;
  } else if (kind == 4) {
    frame.id = 0x18EAFF00U | source, frame.is_extended = true, frame.size = 3;
  } else if (kind <= 6) {
    frame.id = 0x18EEFF00U | source, frame.is_extended = true, frame.size = 8;
  } else {
    frame.is_extended = source % 2 != 0;
    frame.id = (source << 16 | static_cast<std::uint32_t>(choices.byte()) << 8 | choices.byte()) &
               (frame.is_extended ? 0x1FFFFFFFU : 0x7FFU);
  }
  for (std::size_t i = 0; i < frame.size; ++i) frame.bytes[i] = static_cast<std::byte>(choices.byte());
  // heartbeats of real states, claims with NAMEs around the device's own
  constexpr std::array kStates = {0x00, 0x04, 0x05, 0x7F};
  if (kind == 2) frame.bytes[0] = static_cast<std::byte>(kStates[choices.below(4)]);
  if (kind == 4) frame.bytes = {std::byte{0x00}, std::byte{0xEE}, std::byte{0x00}};
  if (kind == 5) {
    const std::uint64_t near = name + choices.below(3) - 1;
    for (unsigned i = 0; i < 8; ++i) frame.bytes[i] = static_cast<std::byte>(near >> (8 * i) & 0xFF);
  }
  return frame;
}

CanOpenDef network_def(fuzz::Choices& choices) {
  CanOpenDef def;
  def.own_node = static_cast<std::int64_t>(choices.below(3));
  def.own_heartbeat = 0.005 + 0.001 * choices.byte();
  def.sync = choices.below(2) == 0 ? 0 : 0.002 + 0.001 * choices.byte();
  for (std::int64_t node = 3; node < 3 + static_cast<std::int64_t>(choices.below(4)); ++node) {
    def.nodes.push_back({.node = node, .heartbeat = 0.001 * choices.byte(), .is_started = choices.below(3) != 0});
  }
  Problems problems;
  validate("fuzz", def, problems);
  fuzz::require(problems.empty());
  return def;
}

void check_sent(const CanOpenDef& def, const std::vector<CanFrame>& frames) {
  for (const CanFrame& frame : frames) {
    fuzz::require(!frame.is_extended);
    if (frame.id == kNmtCobId) {
      const auto request = read_nmt(frame.id, frame.data());
      fuzz::require(request && request->command == NmtCommand::start);
      fuzz::require(std::any_of(def.nodes.begin(), def.nodes.end(), [&](const CanOpenNodeDef& node) {
        return node.is_started && static_cast<unsigned>(node.node) == request->node;
      }));
    } else if (frame.id == kSyncCobId) {
      fuzz::require(def.sync > 0 && frame.size == 0);
    } else {
      const auto beat = read_heartbeat(frame.id, frame.data());
      fuzz::require(beat && def.own_node != 0 && beat->node == static_cast<unsigned>(def.own_node));
    }
  }
}

void try_network(fuzz::Choices& choices) {
  const CanOpenDef def = network_def(choices);
  CanOpenNetwork network(def);
  std::vector<CanFrame> frames;
  std::int64_t now_ns = kMs;
  network.connect(now_ns, frames);
  check_sent(def, frames);
  for (int i = 0; i < kMostSteps && choices.has_more(); ++i) {
    frames.clear();
    if (choices.below(3) == 0) now_ns += static_cast<std::int64_t>(choices.byte()) * kMs;
    network.take(frame_of(choices, 0), now_ns, frames);
    network.advance(now_ns, frames);
    check_sent(def, frames);
    // a start for each node, a boot-up, a heartbeat, a SYNC
    fuzz::require(frames.size() <= def.nodes.size() + 3);
    fuzz::require(network.take_events().size() <= def.nodes.size() + 3);
    fuzz::require(network.due_ns() > now_ns);
    for (std::size_t k = 0; k < def.nodes.size(); ++k) {
      const CanOpenNode& node = network.nodes()[k];
      const bool is_fresh = node.presence == NodePresence::present && node.state == NmtState::operational &&
                            static_cast<double>(now_ns - node.heard_ns) <= def.nodes[k].heartbeat * 1e9 + 1;
      const bool is_operational = network.is_operational(static_cast<unsigned>(def.nodes[k].node));
      fuzz::require(def.nodes[k].heartbeat == 0 ? is_operational : is_operational == is_fresh);
      fuzz::require(def.nodes[k].is_started || node.starts == 0);
    }
  }
}

void try_claim(fuzz::Choices& choices) {
  const J1939UnitDef def{.address = static_cast<std::int64_t>(choices.below(254)),
                         .has_arbitrary_address = choices.below(2) != 0,
                         .identity = choices.byte()};
  J1939Claim claim(def);
  const std::uint64_t name = claim.name();
  std::vector<CanFrame> frames;
  std::int64_t now_ns = kMs, sent_ns = 0;  // sent: the first claim of the present address
  std::uint8_t claimed = kJ1939NullAddress;
  const auto check = [&] {
    for (const CanFrame& frame : frames) {
      const J1939Id id = split_j1939(frame.id);
      fuzz::require(frame.is_extended && id.pgn == kPgnAddressClaimed && id.destination == kJ1939ToAll);
      std::uint64_t sent = 0;
      for (std::size_t i = 8; i > 0; --i) sent = sent << 8 | std::to_integer<std::uint64_t>(frame.bytes[i - 1]);
      fuzz::require(frame.size == 8 && sent == name);
      fuzz::require(id.source == kJ1939NullAddress || id.source == def.address ||
                    (def.has_arbitrary_address && id.source >= 128 && id.source <= 247));
      if (id.source == claimed || id.source == kJ1939NullAddress) continue;
      claimed = id.source;
      sent_ns = now_ns;
    }
    const bool has_address = claim.address() != kJ1939NullAddress;
    fuzz::require(has_address == (claim.phase() == ClaimPhase::claimed));
    fuzz::require(!has_address || now_ns - sent_ns >= kContestNs);
    frames.clear();
  };
  claim.connect(now_ns, frames);
  check();
  for (int i = 0; i < kMostSteps && choices.has_more(); ++i) {
    if (choices.below(3) == 0) now_ns += static_cast<std::int64_t>(choices.byte()) * kMs;
    const ClaimPhase before = claim.phase();
    CanFrame frame = frame_of(choices, name);
    // mostly of its own address
    if (choices.below(2) == 0 && frame.is_extended && claim.address() != kJ1939NullAddress)
      frame.id = (frame.id & 0x1FFFFF00U) | claim.address();
    claim.take(frame, now_ns, frames);
    fuzz::require(frames.size() <= 1);
    claim.advance(now_ns, frames);
    fuzz::require(frames.size() <= 2);
    // a lost claim never returns by itself
    fuzz::require(before != ClaimPhase::lost || claim.phase() == ClaimPhase::lost);
    fuzz::require(claim.take_events().size() <= 2);
    check();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  fuzz::Choices choices(data + 1, size - 1);
  if (data[0] % 2 == 0) {
    try_network(choices);
  } else {
    try_claim(choices);
  }
  return 0;
}
