// SPDX-License-Identifier: Apache-2.0
#include "recording/state_hashes.h"

#include <algorithm>
#include <limits>

#include "core/state_hash.h"

namespace slew::recording {
namespace {

constexpr std::uint32_t kLittleEndianCdr = 0x0100;  // bytes 00 01 00 00

}  // namespace

void StateHashes::add(StepIndex step, std::uint64_t state_hash) noexcept {
  StateHash hash;
  hash.add(step);
  hash.add(state_hash);
  first_step = count == 0 ? step : std::min(first_step, step);
  last_step = count == 0 ? step : std::max(last_step, step);
  digest += hash.digest();
  ++count;
}

void StateHashes::add(const StateHashes& part) noexcept {
  if (count == 0) {
    role = part.role;
    epoch = part.epoch;
  }
  first_step = count == 0 ? part.first_step : std::min(first_step, part.first_step);
  last_step = count == 0 ? part.last_step : std::max(last_step, part.last_step);
  digest += part.digest;
  count += part.count;
}

// every field stands at a multiple of its size behind the encapsulation
void encode_state_hashes(const StateHashes& hashes, Bytes& out) {
  out.clear();
  put(out, kLittleEndianCdr);
  put(out, hashes.first_step);
  put(out, hashes.last_step);
  put(out, hashes.role);
  put(out, hashes.epoch);
  put(out, hashes.digest);
  put(out, hashes.count);
}

bool decode_state_hashes(ByteSpan payload, StateHashes& hashes) noexcept {
  ByteSource source(payload);
  if (source.take<std::uint32_t>() != kLittleEndianCdr) return false;
  hashes.first_step = source.take<StepIndex>();
  hashes.last_step = source.take<StepIndex>();
  hashes.role = source.take<std::uint32_t>();
  hashes.epoch = source.take<std::uint32_t>();
  hashes.digest = source.take<std::uint64_t>();
  hashes.count = source.take<std::uint32_t>();
  const bool has_next_step = hashes.last_step < std::numeric_limits<StepIndex>::max();
  return source.is_valid() && hashes.count > 0 && hashes.first_step >= 0 && hashes.first_step <= hashes.last_step &&
         has_next_step && hash_block_of(hashes.first_step) == hash_block_of(hashes.last_step);
}

}  // namespace slew::recording
