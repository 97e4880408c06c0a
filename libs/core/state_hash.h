// SPDX-License-Identifier: Apache-2.0
// 64-bit hash of the raw bits of a state (XXH3), the unit of every determinism check.
//
// -0.0 and 0.0 differ, NaN payloads count: equal hashes mean equal bits. Values are added in id order by the owner.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

namespace slew {

class StateHash {
 public:
  void add(std::span<const double> values) noexcept { add_bytes(values.data(), values.size_bytes()); }
  template <typename T>
  requires std::is_arithmetic_v<T> || std::is_enum_v<T>
  void add(T value) noexcept { add_bytes(&value, sizeof value); }
  void add_bytes(const void* bytes, std::size_t size) noexcept;

  [[nodiscard]] std::uint64_t digest() const noexcept { return digest_; }

 private:
  std::uint64_t digest_ = 0;
};

// Digest of a message: the sum over messages compares two sets of them, independent of their order.
[[nodiscard]] inline std::uint64_t digest_of(std::span<const std::byte> bytes) noexcept {
  StateHash hash;
  hash.add_bytes(bytes.data(), bytes.size());
  return hash.digest();
}

}  // namespace slew
