// SPDX-License-Identifier: Apache-2.0
#include "devices/packet_checksum.h"

namespace slew::devices {
namespace {

constexpr std::uint32_t kCcittPolynomial = 0x1021;
constexpr std::uint32_t kIeeePolynomialReflected = 0xEDB88320;

std::uint32_t start_of_checksum(Checksum kind) noexcept {
  switch (kind) {
    case Checksum::crc16_ccitt:
      return 0xFFFF;
    case Checksum::crc32:
      return 0xFFFFFFFF;
    case Checksum::sum8:
    case Checksum::xor8:
      break;
  }
  return 0;
}

std::uint32_t add_byte(Checksum kind, std::uint32_t sum, std::uint32_t byte) noexcept {
  switch (kind) {
    case Checksum::sum8:
      return (sum + byte) & 0xFF;
    case Checksum::xor8:
      return sum ^ byte;
    case Checksum::crc16_ccitt:
      sum ^= byte << 8;
      for (int bit = 0; bit < 8; ++bit) sum = (sum & 0x8000) != 0 ? (sum << 1) ^ kCcittPolynomial : sum << 1;
      return sum & 0xFFFF;
    case Checksum::crc32:
      sum ^= byte;
      for (int bit = 0; bit < 8; ++bit) sum = (sum & 1) != 0 ? (sum >> 1) ^ kIeeePolynomialReflected : sum >> 1;
      return sum;
  }
  return 0;
}

}  // namespace

std::size_t checksum_size(Checksum kind) noexcept {
  switch (kind) {
    case Checksum::crc16_ccitt:
      return 2;
    case Checksum::crc32:
      return 4;
    case Checksum::sum8:
    case Checksum::xor8:
      break;
  }
  return 1;
}

std::uint32_t checksum_of(Checksum kind, std::span<const std::byte> first, std::span<const std::byte> second) noexcept {
  std::uint32_t sum = start_of_checksum(kind);
  for (const std::byte byte : first) sum = add_byte(kind, sum, std::to_integer<std::uint32_t>(byte));
  for (const std::byte byte : second) sum = add_byte(kind, sum, std::to_integer<std::uint32_t>(byte));
  return kind == Checksum::crc32 ? ~sum : sum;
}

}  // namespace slew::devices
