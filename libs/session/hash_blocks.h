// SPDX-License-Identifier: Apache-2.0
// The digests of state hashes of one epoch of a recording without samples, until the steps that they cover have been
// computed again.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <vector>

#include "core/time.h"
#include "recording/state_hashes.h"
#include "transport/wire.h"

namespace slew::session {

class HashBlocks {
 public:
  using Key = std::pair<StepIndex, wire::Role>;  // block and writer

  // Adds a part of a block to the others of it.
  void add(const recording::StateHashes& part) {
    blocks_[{recording::hash_block_of(part.first_step), static_cast<wire::Role>(part.role)}].add(part);
  }

  // Blocks whose steps lie in front of a step, or all, are taken out when they are whole.
  // samples_in: number of samples that their writer makes at the steps from the first to the last.
  using Samples = std::function<std::uint32_t(wire::Role, StepIndex first, StepIndex last)>;
  [[nodiscard]] std::vector<recording::StateHashes> take_whole(StepIndex end, const Samples& samples_in) {
    std::vector<recording::StateHashes> whole;
    for (auto at = blocks_.begin(); at != blocks_.end() && at->first.first * recording::kHashedSteps < end;) {
      const recording::StateHashes& block = at->second;
      const bool is_whole =
          block.last_step < end && samples_in(at->first.second, block.first_step, block.last_step) == block.count;
      if (is_whole) whole.push_back(block);
      at = is_whole ? blocks_.erase(at) : std::next(at);
    }
    return whole;
  }

  // What is left: blocks that lack a part, or whose steps were not computed.
  [[nodiscard]] std::vector<recording::StateHashes> take_rest() {
    std::vector<recording::StateHashes> rest;
    for (const auto& [key, block] : blocks_) rest.push_back(block);
    blocks_.clear();
    return rest;
  }
  [[nodiscard]] bool is_empty() const noexcept { return blocks_.empty(); }

 private:
  std::map<Key, recording::StateHashes> blocks_;
};

}  // namespace slew::session
