// SPDX-License-Identifier: Apache-2.0
// The encoded step messages that a node has sent, kept to be resent. A resent message changes nothing at its readers.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/time.h"
#include "node/step_ring.h"

namespace slew::node {

// Least number of messages kept.
inline constexpr std::size_t kSentDepth = 1024;
// Most messages sent for one request: a request after a long silence must not make the sender late. A node that lacks
// more requests again once these have arrived.
inline constexpr StepIndex kMostAnswers = 128;
// Largest size of one cache, where steps are short and messages long.
inline constexpr std::size_t kSentBytes = std::size_t{64} << 20;

// A node that resumes just before it is given up has this time to request the messages it lacks.
inline constexpr SimDuration kRequestTime = {500'000'000};
// Shortest step message: encapsulation and header.
inline constexpr std::size_t kLeastMessage = 44;

// Most messages that a node can lack after a silence for which it is not given up, while it requests them.
[[nodiscard]] constexpr std::size_t sent_depth(SimDuration give_up_after, SimDuration step) noexcept {
  const std::int64_t steps = step.ns > 0 ? (give_up_after.ns + kRequestTime.ns + step.ns - 1) / step.ns : 0;
  return std::clamp(static_cast<std::size_t>(steps), kSentDepth, kSentBytes / kLeastMessage);
}

class SentCache {
 public:
  explicit SentCache(std::size_t depth = kSentDepth) : ring_(depth) {}

  // Pre-condition: the cache is empty.
  void set_depth(std::size_t depth) {
    ring_ = StepRing<std::vector<std::byte>>(depth);
    reserved_ = 0;
  }
  // Reserves messages of this size in all places, so that no step allocates.
  void reserve(std::size_t bytes) {
    if (bytes <= reserved_) return;
    const std::size_t most = std::max(kSentDepth, kSentBytes / bytes);
    if (reserved_ == 0 && depth() > most) set_depth(most);
    reserved_ = bytes;
    ring_.for_each([bytes](std::vector<std::byte>& slot) { slot.reserve(bytes); });
  }
  // The first message reserves the memory of all places. A larger one, such as a tick with commands, allocates for its
  // own place only: a step must not pay for all places.
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
