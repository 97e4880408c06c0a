// SPDX-License-Identifier: Apache-2.0
// Duties of a device on CAN besides its values: with CANopen it starts and watches nodes, sends heartbeats and SYNC;
// with J1939 it claims an address.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/json.h"
#include "device_node/can_bus.h"
#include "devices/canopen_network.h"
#include "devices/j1939_claim.h"
#include "scene/devices.h"

namespace slew::device_node {

enum class BusPart : std::uint8_t {
  takes_part,
  listens  // sends nothing: a monitor, or recorded frames
};

class BusProtocol {
 public:
  BusProtocol(const scene::CanBusDef& bus, BusPart part);

  // The interface was opened.
  void connect(std::int64_t now_ns);
  void take(const CanFrame& frame, std::int64_t now_ns);
  // Called after all frames that have arrived were taken.
  void advance(std::int64_t now_ns);
  // Time of the next frame that is due by itself; the largest: none.
  [[nodiscard]] std::int64_t due_ns() const noexcept;
  // To be sent, since the last call.
  [[nodiscard]] std::vector<CanFrame> take_frames();
  // At most one a second for each node, the newest; the counts have all.
  [[nodiscard]] std::vector<std::string> take_notices();

  // CANopen: the values of a message count, or it may be sent: its node is operational.
  [[nodiscard]] bool is_operational(std::size_t message) const noexcept;
  [[nodiscard]] bool is_of_own_node(std::size_t message) const noexcept;
  struct NodeChange {
    std::size_t message = 0;
    bool is_operational = false;  // false: its values from before are void
  };
  // Since the last call, in their order.
  [[nodiscard]] std::vector<NodeChange> take_changes();
  // SYNC messages, sent and received.
  [[nodiscard]] std::uint64_t syncs() const noexcept { return network_ ? network_->syncs() : 0; }

  // J1939: false for a frame that has another destination.
  [[nodiscard]] bool is_for_us(const CanFrame& frame) const noexcept;
  // The identifier with the claimed address as its source; none: there is no address at present.
  [[nodiscard]] std::optional<std::uint32_t> sent_id(std::uint32_t id, bool is_extended) const noexcept;

  void add_counts(Json& json) const;
  // State of nodes and address, for a monitor.
  [[nodiscard]] std::string text() const;

 private:
  void take_events();
  void note(unsigned key, std::string text);

  std::optional<devices::CanOpenNetwork> network_;
  std::optional<devices::J1939Claim> claim_;
  std::optional<std::uint8_t> fixed_address_;  // without a claim of its own: whose messages are read
  std::vector<unsigned> node_of_;              // by message
  std::vector<CanFrame> frames_;
  std::vector<NodeChange> changes_;
  struct Notice {
    std::string text;
    std::int64_t earliest_ns = 0;
  };
  std::map<unsigned, Notice> pending_;  // by node
  std::vector<std::string> notices_;
};

}  // namespace slew::device_node
