// SPDX-License-Identifier: Apache-2.0
// A UDP socket: bound to receive, or to send from.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "devices/udp_address.h"

namespace slew::device_node {

class UdpSocket {
 public:
  // Bound to the address. Throws Failure (resources) when it is taken or is none of this machine.
  explicit UdpSocket(const devices::UdpAddress& address);
  // For sending: bound to no address of its own.
  UdpSocket();
  ~UdpSocket();
  UdpSocket(const UdpSocket&) = delete;
  UdpSocket& operator=(const UdpSocket&) = delete;

  [[nodiscard]] int descriptor() const noexcept { return fd_; }

  struct Packet {
    std::uint32_t sender = 0;  // host
    std::size_t size = 0;      // of the packet, which may be more than the buffer holds
  };
  // The next packet; none: nothing has come. Does not wait.
  [[nodiscard]] std::optional<Packet> receive(std::span<std::byte> buffer) noexcept;
  // False: the system did not take it.
  [[nodiscard]] bool send(const devices::UdpAddress& to, std::span<const std::byte> bytes) noexcept;

 private:
  int fd_ = -1;
};

}  // namespace slew::device_node
