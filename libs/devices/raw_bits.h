// SPDX-License-Identifier: Apache-2.0
// Numbers of 1 to 64 bits in messages: masks, signs and bounds.
#pragma once

#include <cmath>
#include <cstdint>

namespace slew::devices {

[[nodiscard]] constexpr std::uint64_t mask_of(unsigned bits) noexcept {
  return bits >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << bits) - 1;
}

// Number that the bits mean, in two's complement when it has a sign. Rounded beyond 2^53.
[[nodiscard]] inline double number_of(std::uint64_t word, unsigned bits, bool has_sign) noexcept {
  if (!has_sign) return static_cast<double>(word);
  const std::uint64_t sign = std::uint64_t{1} << (bits - 1);
  return static_cast<double>(static_cast<std::int64_t>((word ^ sign) - sign));
}

// Bits of a whole number. Pre-condition: number within least_number() .. greatest_number().
[[nodiscard]] inline std::uint64_t word_of(double number, unsigned bits) noexcept {
  const std::uint64_t word =
      number < 0 ? static_cast<std::uint64_t>(static_cast<std::int64_t>(number)) : static_cast<std::uint64_t>(number);
  return word & mask_of(bits);
}

// Bounds as doubles: that of 64 bits is the largest double below 2^64, not 2^64 - 1.
[[nodiscard]] inline double least_number(unsigned bits, bool has_sign) noexcept {
  return has_sign ? -std::ldexp(1.0, static_cast<int>(bits) - 1) : 0;
}
[[nodiscard]] inline double greatest_number(unsigned bits, bool has_sign) noexcept {
  const double beyond = std::ldexp(1.0, static_cast<int>(bits) - (has_sign ? 1 : 0));
  return bits > 53 ? std::nextafter(beyond, 0.0) : beyond - 1;
}

}  // namespace slew::devices
