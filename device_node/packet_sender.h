// SPDX-License-Identifier: Apache-2.0
// Sends packets of one layout and counts them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/json.h"
#include "device_node/udp_socket.h"
#include "devices/packet.h"

namespace slew::device_node {

// False: the system did not take it.
using SendBytes = std::function<bool(std::span<const std::byte>)>;

class PacketSender {
 public:
  // address: as parse_udp_address() takes it. send: of the caller, for tests; none: the network. Throws Failure.
  PacketSender(const devices::LayoutDef& layout, const std::string& address, SendBytes send);

  [[nodiscard]] const devices::ByteLayout& layout() const noexcept { return layout_; }
  [[nodiscard]] bool is_on_network() const noexcept { return socket_ != nullptr; }
  // One value for each of layout().values. A packet with a value that is not finite is not sent, and counted.
  void send(std::span<const double> values);
  void add_counts(Json& json) const;

 private:
  devices::ByteLayout layout_;
  devices::PacketState state_;
  std::vector<std::byte> packet_;
  std::unique_ptr<UdpSocket> socket_;  // null: the caller sends
  SendBytes send_;
  std::uint64_t sent_ = 0, unsent_ = 0;
};

}  // namespace slew::device_node
