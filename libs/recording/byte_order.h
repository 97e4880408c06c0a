// SPDX-License-Identifier: Apache-2.0
// Little-endian byte strings: appending to a buffer, and reading from an untrusted one.
//
// MCAP serialisation: integers little-endian; String = uint32 length + bytes; Map = uint32 byte length + entries.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <type_traits>
#include <vector>

namespace slew::recording {

static_assert(std::endian::native == std::endian::little, "the recording format is little-endian");

using Bytes = std::vector<std::byte>;
using ByteSpan = std::span<const std::byte>;

[[nodiscard]] inline ByteSpan as_byte_span(std::string_view text) noexcept {
  return {reinterpret_cast<const std::byte*>(text.data()), text.size()};
}
[[nodiscard]] inline std::string_view as_text(ByteSpan bytes) noexcept {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

inline void put_bytes(Bytes& out, ByteSpan bytes) {
  out.insert(out.end(), bytes.begin(), bytes.end());
}

template <typename T>
requires std::is_integral_v<T>
void put(Bytes& out, T value) {
  put_bytes(out, std::as_bytes(std::span<const T, 1>(&value, 1)));
}

inline void put_string(Bytes& out, std::string_view text) {
  put(out, static_cast<std::uint32_t>(text.size()));
  put_bytes(out, as_byte_span(text));
}

// Overwrites an integer that was appended before.
template <typename T>
requires std::is_integral_v<T>
void put_at(Bytes& out, std::size_t position, T value) noexcept {
  std::memcpy(out.data() + position, &value, sizeof value);
}

// Takes values from the front of a byte string. Past the end every read gives zero and is_valid() turns false: the
// caller checks once after a group of reads.
class ByteSource {
 public:
  explicit ByteSource(ByteSpan bytes) noexcept : bytes_(bytes) {}

  template <typename T>
  requires std::is_integral_v<T>
  [[nodiscard]] T take() noexcept {
    T value = 0;
    const ByteSpan bytes = take_bytes(sizeof value);
    if (bytes.size() == sizeof value) std::memcpy(&value, bytes.data(), sizeof value);
    return value;
  }

  [[nodiscard]] ByteSpan take_bytes(std::uint64_t size) noexcept {
    if (!is_valid_ || size > bytes_.size() - position_) {
      is_valid_ = false;
      return {};
    }
    const ByteSpan taken = bytes_.subspan(position_, size);
    position_ += size;
    return taken;
  }

  [[nodiscard]] std::string_view take_string() noexcept { return as_text(take_bytes(take<std::uint32_t>())); }

  [[nodiscard]] bool is_valid() const noexcept { return is_valid_; }
  [[nodiscard]] bool is_empty() const noexcept { return !is_valid_ || position_ == bytes_.size(); }
  [[nodiscard]] std::size_t position() const noexcept { return position_; }
  [[nodiscard]] std::size_t left() const noexcept { return is_valid_ ? bytes_.size() - position_ : 0; }

 private:
  ByteSpan bytes_;
  std::size_t position_ = 0;
  bool is_valid_ = true;
};

}  // namespace slew::recording
