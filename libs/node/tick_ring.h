// The ticks that a node still needs, by step.
#pragma once

#include <cstddef>
#include <span>

#include "node/sample_exchange.h"
#include "node/session_member.h"
#include "node/step_ring.h"

namespace slew::node {

class TickRing {
 public:
  // Keeps the tick of a step that is still to be done, once. n: the next step to do. False: the tick was dropped and
  // counted in `refusals`.
  bool keep(std::span<const std::byte> bytes, StepIndex step, StepIndex n, Refusals& refusals) {
    if (step >= n + static_cast<StepIndex>(kRingDepth)) {
      ++refusals.too_far_ahead;
    } else if (step < n || ring_.find(step) != nullptr) {
      ++refusals.duplicate;
    } else if (!transport::decode(bytes, ring_.put(step))) {
      ring_.remove(step);
      ++refusals.undecodable;
    } else {
      return true;
    }
    return false;
  }
  [[nodiscard]] const wire::Tick* find(StepIndex step) const noexcept { return ring_.find(step); }
  void clear() noexcept { ring_.clear(); }

 private:
  StepRing<wire::Tick> ring_{kRingDepth};
};

}  // namespace slew::node
