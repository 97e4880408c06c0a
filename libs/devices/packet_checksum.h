// SPDX-License-Identifier: Apache-2.0
// Checksums of packets, over a range of bytes that may be given in pieces.
//
//   sum8         sum of all bytes modulo 256
//   xor8         exclusive or of all bytes
//   crc16_ccitt  polynomial 0x1021, start 0xFFFF, not reflected (CRC-16/IBM-3740); of "123456789": 0x29B1
//   crc32        polynomial 0x04C11DB7, reflected, start and end inverted (IEEE 802.3); of "123456789": 0xCBF43926
//
// The name CCITT is in use for several start values and bit orders: Python's binascii.crc_hqx(data, 0xFFFF) is this
// one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace slew::devices {

enum class Checksum : std::uint8_t { sum8, xor8, crc16_ccitt, crc32 };

// Size of the result [bytes].
[[nodiscard]] std::size_t checksum_size(Checksum kind) noexcept;

// Checksum of the two pieces, one behind the other.
[[nodiscard]] std::uint32_t checksum_of(Checksum kind, std::span<const std::byte> first,
                                        std::span<const std::byte> second) noexcept;

}  // namespace slew::devices
