// SPDX-License-Identifier: Apache-2.0
#include "core/state_hash.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace slew {

// each block is hashed with the digest so far as its seed: order and boundaries both count
void StateHash::add_bytes(const void* bytes, std::size_t size) noexcept {
  digest_ = XXH3_64bits_withSeed(bytes, size, digest_);
}

}  // namespace slew
