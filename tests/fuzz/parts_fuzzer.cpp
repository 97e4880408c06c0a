// SPDX-License-Identifier: Apache-2.0
// States in parts: with any parts in any order, a state is whole when each of its parts has arrived, and holds the
// bytes of its own parts alone; a part without a place in it changes nothing.
#include <algorithm>
#include <array>
#include <cstring>
#include <map>
#include <tuple>

#include "node/checkpoint.h"
#include "tests/fuzz/bytes.h"

namespace {

using namespace slew;

constexpr std::size_t kPart = wire::kMaxStatePart;
constexpr StepIndex kSteps[] = {128, 256, 0, 384, 512, 640, kJoinStep, wire::kMaxStep};
constexpr std::uint32_t kTotals[] = {3 * kPart, 1, kPart,           kPart + 1,   2 * kPart + 5,
                                     kPart - 1, 0, 4 * kPart - 100, 0xffffffffu, wire::kMaxStateBytes + 1};

// Every place of every state has a byte of its own, all through.
std::uint8_t byte_of(StepIndex step, std::uint64_t hash, std::size_t total, std::size_t place) {
  return static_cast<std::uint8_t>(static_cast<std::uint64_t>(step) / 128 * 101 + hash * 37 + total * 7 + place * 13);
}

wire::StatePart some_part(fuzz::Choices& choices) {
  wire::StatePart part;
  part.header.step = kSteps[choices.below(std::size(kSteps))];
  part.state_hash = choices.below(2);
  // the longest is seldom: it takes long
  const std::uint8_t total = choices.byte();
  part.total = total == 255 ? wire::kMaxStateBytes : kTotals[total % std::size(kTotals)];
  const std::size_t place = choices.below(8);
  part.first = place == 7 ? 0xffffffffu - choices.byte() : static_cast<std::uint32_t>(place * kPart);
  std::size_t size = part.first < part.total ? std::min<std::size_t>(kPart, part.total - part.first) : kPart;
  // three of sixteen lie beside their place, are too short or too long
  switch (choices.below(16)) {
    case 1:
      part.first += 1 + choices.byte();
      break;
    case 2:
      size -= std::min(size, std::size_t{1} + choices.byte());
      break;
    case 3:
      size = std::min(kPart, size + 1 + choices.byte());
      break;
    default:
      break;
  }
  part.bytes.resize(size);
  if (size == 0) return part;
  std::memset(part.bytes.data(), byte_of(part.header.step, part.state_hash, part.total, part.first / kPart), size);
  return part;
}

// Expected contents of CheckpointParts: the places of one state that have arrived.
class Expected {
 public:
  [[nodiscard]] static bool has_place(const wire::StatePart& part) {
    const std::uint64_t end = std::uint64_t{part.first} + part.bytes.size();
    const bool is_full_or_last = part.bytes.size() == kPart || end == part.total;
    return part.header.step >= 0 && part.total > 0 && part.total <= wire::kMaxStateBytes && part.first % kPart == 0 &&
           !part.bytes.empty() && end <= part.total && is_full_or_last;
  }
  bool take(const wire::StatePart& part) {
    if (!has_place(part)) return false;
    const State state{part.header.step, part.state_hash, part.total};
    if (state != state_) places_.clear();
    state_ = state;
    const bool is_new = places_.emplace(part.first, part.bytes.size()).second;
    return is_new && is_whole();
  }
  [[nodiscard]] bool has(const wire::StatePart& part) const {
    return State{part.header.step, part.state_hash, part.total} == state_ && has_place(part) &&
           places_.contains(part.first);
  }
  [[nodiscard]] bool is_whole() const {
    std::size_t bytes = 0;
    for (const auto& [first, size] : places_) bytes += size;
    return bytes > 0 && bytes == std::get<2>(state_);
  }
  void clear() { places_.clear(); }

 private:
  using State = std::tuple<StepIndex, std::uint64_t, std::uint32_t>;
  State state_;
  std::map<std::size_t, std::size_t> places_;  // first byte and size
};

void require_own_bytes(const node::Checkpoint& checkpoint) {
  fuzz::require(checkpoint.step >= 0 && checkpoint.bytes.size() <= wire::kMaxStateBytes);
  static std::array<std::uint8_t, kPart> expected;
  const std::size_t total = checkpoint.bytes.size();
  for (std::size_t first = 0; first < total; first += kPart) {
    expected.fill(byte_of(checkpoint.step, checkpoint.state_hash, total, first / kPart));
    const std::size_t size = std::min(kPart, total - first);
    fuzz::require(std::memcmp(checkpoint.bytes.data() + first, expected.data(), size) == 0);
  }
}

void require_in_order(const node::KeptCheckpoints& kept) {
  std::size_t count = 0;
  for (const StepIndex step : kSteps) {
    const node::Checkpoint* const found = kept.find(step);
    if (found == nullptr) continue;
    ++count;
    fuzz::require(found->step == step);
    require_own_bytes(*found);
  }
  fuzz::require(count <= node::kKeptCheckpoints);
  const auto any = [](StepIndex) { return true; };
  const node::Checkpoint* const oldest = kept.oldest(any);
  const node::Checkpoint* const newest = kept.newest(any);
  fuzz::require((oldest == nullptr) == (count == 0) && (newest == nullptr) == (count == 0));
  fuzz::require(count == 0 || oldest->step <= newest->step);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Choices choices(data, size);
  node::CheckpointParts parts;
  node::KeptCheckpoints kept;
  Expected expected;
  while (choices.has_more()) {
    const wire::StatePart part = some_part(choices);
    fuzz::require(parts.has(part) == expected.has(part));
    const bool is_whole = parts.take(part);
    fuzz::require(is_whole == expected.take(part) && parts.is_whole() == expected.is_whole());
    if (is_whole) require_own_bytes(parts.checkpoint());
    kept.take(part);
    switch (choices.below(64)) {
      case 1:
        parts.clear();
        expected.clear();
        break;
      case 2:
        kept.clear();
        break;
      default:
        break;
    }
  }
  require_in_order(kept);
  return 0;
}
