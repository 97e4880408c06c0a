// Live parameter changes that are spread over a time: value by step, the same in every node that applies them.
//
//   value(n) = from + (to - from) min(1, (n - begin + 1) / steps)
//
// A handle is the owner's number for a parameter. A new change of the same parameter replaces the one under way and
// begins at the value reached. No allocation.
#pragma once

#include <algorithm>
#include <cstddef>

#include "core/state_hash.h"
#include "core/static_vector.h"
#include "core/time.h"

namespace slew::coupling {

class ParameterRamps {
 public:
  static constexpr std::size_t kCapacity = 64;

  // steps: at least 1, in which the target is reached. False when too many changes are under way.
  bool begin(int handle, double from, double to, StepIndex n, StepIndex steps) noexcept {
    Ramp ramp{handle, from, to, n, std::max<StepIndex>(1, steps)};
    for (Ramp& other : ramps_) {
      if (other.handle == handle) {
        other = ramp;
        return true;
      }
    }
    if (ramps_.size() == kCapacity) return false;
    ramps_.push_back(ramp);
    return true;
  }

  // Calls set(handle, value) for every change under way; drops those that reached their target.
  template <typename Set>
  void apply(StepIndex n, Set&& set) noexcept {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < ramps_.size(); ++i) {
      const Ramp ramp = ramps_[i];
      const bool is_done = n - ramp.begin + 1 >= ramp.steps;
      const double share = is_done ? 1.0 : static_cast<double>(n - ramp.begin + 1) / static_cast<double>(ramp.steps);
      set(ramp.handle, is_done ? ramp.to : ramp.from + (ramp.to - ramp.from) * share);
      if (!is_done) ramps_[kept++] = ramp;
    }
    ramps_.resize(kept);
  }

  void clear() noexcept { ramps_.clear(); }
  [[nodiscard]] bool empty() const noexcept { return ramps_.empty(); }

  void add_to(StateHash& hash) const noexcept {
    for (const Ramp& ramp : ramps_) {
      hash.add(ramp.handle);
      hash.add(ramp.from);
      hash.add(ramp.to);
      hash.add(ramp.begin);
      hash.add(ramp.steps);
    }
  }

 private:
  struct Ramp {
    int handle = 0;
    double from = 0, to = 0;
    StepIndex begin = 0, steps = 1;
  };
  StaticVector<Ramp, kCapacity> ramps_;
};

}  // namespace slew::coupling
