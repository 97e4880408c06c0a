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

constexpr std::uint32_t kErrorFlag = 0x20000000;  // beside the class of an error frame, as in <linux/can.h>

struct LoggedHead {
  std::int64_t time_us = 0;
  std::uint32_t id = 0;
  std::size_t digits = 0;  // of the identifier
};

// Time, interface and identifier, up to and with the '#'; what follows stays in the line.
std::optional<LoggedHead> take_logged_head(std::string_view& line) noexcept {
  while (!line.empty() && (line.back() == '\r' || line.back() == '\n' || line.back() == ' ')) line.remove_suffix(1);
  if (line.ends_with(" R") || line.ends_with(" T")) line.remove_suffix(2);
  LoggedHead head;
  std::int64_t seconds = 0, micros = 0;
  if (!take_logged_sign(line, "(") || !take_logged_number(line, seconds, 10) || !take_logged_sign(line, ".") ||
      line.size() < 7 || line[6] != ')' || !take_logged_number(line, micros, 10) || !take_logged_sign(line, ") ") ||
      seconds < 0 || micros < 0 || seconds > INT64_MAX / 2'000'000)
    return std::nullopt;
  head.time_us = seconds * 1'000'000 + micros;
  const std::size_t space = line.find(' ');
  const std::size_t hash = line.find('#');
  if (space == std::string_view::npos || hash == std::string_view::npos || hash < space) return std::nullopt;
  line.remove_prefix(space + 1);
  head.digits = line.find('#');
  // three digits are an identifier of 11 bits, eight one of 29
  if ((head.digits != 3 && head.digits != 8) || !take_logged_number(line, head.id, 16) || !take_logged_sign(line, "#"))
    return std::nullopt;
  return head;
}

bool is_hexadecimal(std::string_view text) noexcept {
  return text.find_first_not_of("0123456789abcdefABCDEF") == std::string_view::npos;
}

}  // namespace

bool is_logged_without_data(std::string_view line) noexcept {
  const std::optional<LoggedHead> head = take_logged_head(line);
  if (!head) return false;
  const bool is_extended = head->digits == 8;
  if (is_extended && (head->id & ~kMostExtendedId) == kErrorFlag)
    return line.size() % 2 == 0 && line.size() / 2 <= kMostBytes && is_hexadecimal(line);
  if (head->id > (is_extended ? kMostExtendedId : kMostStandardId) || !take_logged_sign(line, "R")) return false;
  return line.empty() || (line.size() == 1 && line[0] >= '0' && line[0] <= '8');
}

std::optional<LoggedFrame> parse_candump(std::string_view line) noexcept {
  const std::optional<LoggedHead> head = take_logged_head(line);
  if (!head) return std::nullopt;
  LoggedFrame logged;
  logged.time_us = head->time_us;
  logged.frame.id = head->id;
  logged.frame.is_extended = head->digits == 8;
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
