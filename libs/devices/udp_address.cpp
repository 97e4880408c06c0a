// SPDX-License-Identifier: Apache-2.0
#include "devices/udp_address.h"

#include <fmt/format.h>

#include <charconv>

namespace slew::devices {
namespace {

// A decimal number of 0 to most at the begin of the text, which is shortened by it.
std::optional<unsigned> take_number(std::string_view& text, unsigned most) noexcept {
  unsigned number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  const auto digits = static_cast<std::size_t>(end - text.data());
  // 010 is eight to some readers and ten to others
  if (error != std::errc() || number > most || (digits > 1 && text[0] == '0')) return std::nullopt;
  text.remove_prefix(digits);
  return number;
}

}  // namespace

std::optional<std::uint32_t> parse_host(std::string_view text) noexcept {
  std::uint32_t host = 0;
  for (int i = 0; i < 4; ++i) {
    if (i > 0) {
      if (!text.starts_with('.')) return std::nullopt;
      text.remove_prefix(1);
    }
    const auto byte = take_number(text, 255);
    if (!byte) return std::nullopt;
    host = host << 8 | *byte;
  }
  return text.empty() ? std::optional(host) : std::nullopt;
}

std::optional<UdpAddress> parse_udp_address(std::string_view text) noexcept {
  const std::size_t colon = text.find(':');
  if (colon == std::string_view::npos) return std::nullopt;
  const auto host = parse_host(text.substr(0, colon));
  text.remove_prefix(colon + 1);
  const auto port = take_number(text, 65535);
  if (!host || !port || *port == 0 || !text.empty()) return std::nullopt;
  return UdpAddress{*host, static_cast<std::uint16_t>(*port)};
}

std::string host_text(std::uint32_t host) {
  return fmt::format("{}.{}.{}.{}", host >> 24, host >> 16 & 255, host >> 8 & 255, host & 255);
}

}  // namespace slew::devices
