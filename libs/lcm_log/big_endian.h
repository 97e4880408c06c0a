// SPDX-License-Identifier: Apache-2.0
// Big-endian numbers of LCM: appending to a string, and taking from untrusted bytes.
#pragma once

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>

namespace slew::lcm_log {

template <std::integral Integer>
void put_big_endian(std::string& out, Integer value) {
  const auto bits = static_cast<std::make_unsigned_t<Integer>>(value);
  for (int shift = 8 * static_cast<int>(sizeof value) - 8; shift >= 0; shift -= 8)
    out += static_cast<char>(static_cast<unsigned char>(bits >> shift));
}

// Past the end every take gives zero and is_sound() turns false: the caller checks once after a group.
class BigEndianSource {
 public:
  explicit BigEndianSource(std::string_view bytes) noexcept : bytes_(bytes) {}
  explicit BigEndianSource(std::span<const std::byte> bytes) noexcept
      : bytes_(reinterpret_cast<const char*>(bytes.data()), bytes.size()) {}

  template <std::integral Integer>
  [[nodiscard]] Integer take() noexcept {
    std::make_unsigned_t<Integer> bits = 0;
    for (const char byte : take_bytes(sizeof bits))
      bits = static_cast<std::make_unsigned_t<Integer>>((std::uint64_t{bits} << 8) | static_cast<unsigned char>(byte));
    return static_cast<Integer>(bits);
  }
  [[nodiscard]] double take_double() noexcept { return std::bit_cast<double>(take<std::uint64_t>()); }
  [[nodiscard]] std::string_view take_bytes(std::size_t count) noexcept {
    if (count > bytes_.size()) {
      is_sound_ = false;
      bytes_ = {};
      return {};
    }
    const std::string_view taken = bytes_.substr(0, count);
    bytes_.remove_prefix(count);
    return taken;
  }
  // A string of LCM: length with the NUL at its end, characters, NUL. longest: without the NUL.
  [[nodiscard]] std::string_view take_string(std::size_t longest) noexcept {
    const auto length = take<std::int32_t>();
    if (length < 1 || static_cast<std::size_t>(length) > longest + 1) {
      is_sound_ = false;
      bytes_ = {};
      return {};
    }
    const std::string_view text = take_bytes(static_cast<std::size_t>(length));
    if (!is_sound_ || text.find('\0') + 1 != text.size()) {
      is_sound_ = false;
      return {};
    }
    return text.substr(0, text.size() - 1);
  }
  [[nodiscard]] bool is_sound() const noexcept { return is_sound_; }
  [[nodiscard]] bool is_at_end() const noexcept { return is_sound_ && bytes_.empty(); }

 private:
  std::string_view bytes_;
  bool is_sound_ = true;
};

}  // namespace slew::lcm_log
