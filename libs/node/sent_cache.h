// The encoded step messages a node has sent, kept for those that missed one. Repeating one is idempotent.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/time.h"
#include "node/step_ring.h"

namespace slew::node {

// Messages that are kept at least.
inline constexpr std::size_t kSentDepth = 1024;
// Answered to one request at most: what is asked for after a long silence must not make the answerer late. Who misses
// more asks again when these have come.
inline constexpr StepIndex kMostAnswers = 128;
// Of one cache at most, where steps are short and messages long.
inline constexpr std::size_t kSentBytes = std::size_t{64} << 20;

// A node that comes back just before it is given up has this time to request what it has missed.
inline constexpr SimDuration kRequestTime = {500'000'000};
// No step message is shorter: its encapsulation and its header.
inline constexpr std::size_t kLeastMessage = 44;

// Messages that a node may lack that has been silent without being given up, and is requesting them.
[[nodiscard]] constexpr std::size_t sent_depth(SimDuration give_up_after, SimDuration step) noexcept {
  const std::int64_t steps = step.ns > 0 ? (give_up_after.ns + kRequestTime.ns + step.ns - 1) / step.ns : 0;
  return std::clamp(static_cast<std::size_t>(steps), kSentDepth, kSentBytes / kLeastMessage);
}

class SentCache {
 public:
  explicit SentCache(std::size_t depth = kSentDepth) : ring_(depth) {}

  // How far back it goes. Pre-condition: nothing is kept yet.
  void set_depth(std::size_t depth) {
    ring_ = StepRing<std::vector<std::byte>>(depth);
    reserved_ = 0;
  }
  // Room for messages of this size in all places, so that no step needs memory of its own.
  void reserve(std::size_t bytes) {
    if (bytes <= reserved_) return;
    const std::size_t most = std::max(kSentDepth, kSentBytes / bytes);
    if (reserved_ == 0 && depth() > most) set_depth(most);
    reserved_ = bytes;
    ring_.for_each([bytes](std::vector<std::byte>& slot) { slot.reserve(bytes); });
  }
  // The first message makes room for all that follow. A larger one, as a tick with commands, has memory for itself
  // alone: a step must not pay for all places.
  void keep(StepIndex step, std::span<const std::byte> bytes) {
    if (reserved_ == 0) reserve(bytes.size());
    std::vector<std::byte>& slot = ring_.put(step);
    slot.assign(bytes.begin(), bytes.end());
  }
  [[nodiscard]] std::span<const std::byte> find(StepIndex step) const noexcept {
    const std::vector<std::byte>* slot = ring_.find(step);
    return slot != nullptr ? std::span<const std::byte>(*slot) : std::span<const std::byte>();
  }
  void clear() noexcept { ring_.clear(); }
  [[nodiscard]] std::size_t depth() const noexcept { return ring_.depth(); }

 private:
  StepRing<std::vector<std::byte>> ring_;
  std::size_t reserved_ = 0;
};

}  // namespace slew::node
