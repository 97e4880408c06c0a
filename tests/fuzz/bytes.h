// SPDX-License-Identifier: Apache-2.0
// Input of a fuzzer as a sequence of choices; 0 after its end.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

namespace slew::fuzz {

class Choices {
 public:
  Choices(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}
  [[nodiscard]] bool has_more() const noexcept { return size_ > 0; }
  std::uint8_t byte() noexcept {
    if (size_ == 0) return 0;
    --size_;
    return *data_++;
  }
  // below `count`
  std::size_t below(std::size_t count) noexcept { return byte() % count; }
  // any bits, so NaN, infinities and denormals too
  double number() noexcept {
    std::uint64_t bits = 0;
    for (int i = 0; i < 8; ++i) bits = bits << 8 | byte();
    double value = 0;
    std::memcpy(&value, &bits, sizeof value);
    return value;
  }
  // usual sizes, mostly
  double usual() noexcept {
    const std::uint8_t first = byte();
    return first < 250 ? (static_cast<double>(first) - 125) / 100 : number();
  }

 private:
  const std::uint8_t* data_;
  std::size_t size_;
};

// A claim that a fuzzer makes: ends the program, which keeps the input.
inline void require(bool claim) {
  if (!claim) __builtin_trap();
}

}  // namespace slew::fuzz
