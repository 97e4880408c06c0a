// The encoded step messages a node has sent, kept for those that missed one. Repeating one is idempotent.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "node/step_ring.h"

namespace slew::node {

// A recorder that was stopped for 200 ms at several kHz asks for about this many steps back.
inline constexpr std::size_t kSentDepth = 1024;

class SentCache {
 public:
  explicit SentCache(std::size_t depth = kSentDepth) : ring_(depth) {}

  // Room for messages of this size in all places, so that no step needs memory of its own.
  void reserve(std::size_t bytes) {
    if (bytes <= reserved_) return;
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
