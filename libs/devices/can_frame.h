// SPDX-License-Identifier: Apache-2.0
// A frame of a CAN bus, and the lines in which `candump -l` writes frames.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace slew::devices {

struct CanFrame {
  std::uint32_t id = 0;  // 11 or 29 bits
  bool is_extended = false;
  std::size_t size = 0;  // bytes
  std::array<std::byte, 64> bytes{};

  [[nodiscard]] std::span<const std::byte> data() const noexcept { return std::span(bytes).first(size); }
};

// A line of `candump -l`: "(1700000000.123456) can0 18F00400#0102030405060708", perhaps with its direction, " R" or "
// T". No value: a remote or error frame, or no such line.
struct LoggedFrame {
  std::int64_t time_us = 0;
  CanFrame frame;
};
[[nodiscard]] std::optional<LoggedFrame> parse_candump(std::string_view line) noexcept;
// A line of `candump -l` with a remote frame, "123#R8", or an error frame, which have no data.
[[nodiscard]] bool is_logged_without_data(std::string_view line) noexcept;

}  // namespace slew::devices
