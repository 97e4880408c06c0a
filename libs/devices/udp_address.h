// SPDX-License-Identifier: Apache-2.0
// Addresses of UDP in texts: "127.0.0.1:5005", IPv4 alone.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace slew::devices {

struct UdpAddress {
  std::uint32_t host = 0;  // 127.0.0.1 is 0x7F000001
  std::uint16_t port = 0;
  bool operator==(const UdpAddress&) const = default;

  [[nodiscard]] bool is_loopback() const noexcept { return host >> 24 == 127; }
};

// No value for another form; port 1 to 65535.
[[nodiscard]] std::optional<UdpAddress> parse_udp_address(std::string_view text) noexcept;
// "127.0.0.1", without a port.
[[nodiscard]] std::optional<std::uint32_t> parse_host(std::string_view text) noexcept;
[[nodiscard]] std::string host_text(std::uint32_t host);

}  // namespace slew::devices
