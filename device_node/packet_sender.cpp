// SPDX-License-Identifier: Apache-2.0
#include "device_node/packet_sender.h"

#include <utility>

#include "devices/udp_address.h"

namespace slew::device_node {

PacketSender::PacketSender(const devices::LayoutDef& layout, const std::string& address, SendBytes send)
    : layout_(build(layout)), packet_(layout_.size), send_(std::move(send)) {
  if (send_) return;
  socket_ = std::make_unique<UdpSocket>();
  send_ = [socket = socket_.get(), to = *devices::parse_udp_address(address)](std::span<const std::byte> bytes) {
    return socket->send(to, bytes);
  };
}

void PacketSender::send(std::span<const double> values) {
  if (encode(layout_, values, state_, packet_) != devices::PacketFault::none) return;
  ++(send_(packet_) ? sent_ : unsent_);
}

void PacketSender::add_counts(Json& json) const {
  json["sent"] = sent_;
  json["unsent"] = unsent_;
  json["not_finite"] = state_.counts.of(devices::PacketFault::not_finite);
  json["held"] = state_.counts.held;
}

}  // namespace slew::device_node
