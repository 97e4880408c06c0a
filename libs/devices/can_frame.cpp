// SPDX-License-Identifier: Apache-2.0
#include "devices/can_frame.h"

#include <charconv>

namespace slew::devices {
namespace {

constexpr std::uint32_t kMostStandardId = 0x7FF, kMostExtendedId = 0x1FFFFFFF;
constexpr std::size_t kMostBytes = 8, kMostFdBytes = 64;

// A number at the begin of the text, which is shortened by it.
template <typename Number>
bool take_logged_number(std::string_view& text, Number& number, int base) noexcept {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number, base);
  if (error != std::errc()) return false;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return true;
}

bool take_logged_sign(std::string_view& text, std::string_view sign) noexcept {
  if (!text.starts_with(sign)) return false;
  text.remove_prefix(sign.size());
  return true;
}

}  // namespace

std::optional<LoggedFrame> parse_candump(std::string_view line) noexcept {
  while (!line.empty() && (line.back() == '\r' || line.back() == '\n' || line.back() == ' ')) line.remove_suffix(1);
  LoggedFrame logged;
  std::int64_t seconds = 0, micros = 0;
  if (!take_logged_sign(line, "(") || !take_logged_number(line, seconds, 10) || !take_logged_sign(line, ".") ||
      line.size() < 7 || line[6] != ')' || !take_logged_number(line, micros, 10) || !take_logged_sign(line, ") ") ||
      seconds < 0 || micros < 0 || seconds > INT64_MAX / 2'000'000)
    return std::nullopt;
  logged.time_us = seconds * 1'000'000 + micros;
  const std::size_t space = line.find(' ');
  const std::size_t hash = line.find('#');
  if (space == std::string_view::npos || hash == std::string_view::npos || hash < space) return std::nullopt;
  line.remove_prefix(space + 1);
  const std::size_t digits = line.find('#');
  // three digits are an identifier of 11 bits, eight one of 29
  if ((digits != 3 && digits != 8) || !take_logged_number(line, logged.frame.id, 16) || !take_logged_sign(line, "#"))
    return std::nullopt;
  logged.frame.is_extended = digits == 8;
  if (logged.frame.id > (logged.frame.is_extended ? kMostExtendedId : kMostStandardId)) return std::nullopt;
  const bool is_fd = take_logged_sign(line, "#");
  if (is_fd) {
    if (line.empty()) return std::nullopt;
    line.remove_prefix(1);  // flags
  }
  const std::size_t most = is_fd ? kMostFdBytes : kMostBytes;
  if (line.size() % 2 != 0 || line.size() / 2 > most) return std::nullopt;
  for (logged.frame.size = 0; !line.empty(); ++logged.frame.size) {
    std::string_view pair = line.substr(0, 2);
    std::uint8_t byte = 0;
    if (!take_logged_number(pair, byte, 16) || !pair.empty()) return std::nullopt;
    logged.frame.bytes[logged.frame.size] = std::byte{byte};
    line.remove_prefix(2);
  }
  return logged;
}

}  // namespace slew::devices
