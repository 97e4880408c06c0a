// Tells whether two programs have the same messages, in whatever order they came: the sum of their digests.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/state_hash.h"

namespace slew::node {

[[nodiscard]] inline std::uint64_t digest_of(std::span<const std::byte> message) noexcept {
  StateHash hash;
  hash.add_bytes(message.data(), message.size());
  return hash.digest();
}

}  // namespace slew::node
