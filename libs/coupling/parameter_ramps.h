// SPDX-License-Identifier: Apache-2.0
// Live parameter changes that are spread over a time: value by step, the same in every node that applies them.
//
//   value(n) = from + (to - from) min(1, (n - begin + 1/2) / steps)
//
// A step has the mean of the straight line over it, the step behind the line's end the target itself. A change that
// takes no time has its target from its first step on.
//
// A handle is the owner's number for a parameter. A new change of the same parameter replaces the current one and
// begins where the line is; so capacity for all parameters suffices for all changes. Only the constructor allocates.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "core/check.h"
#include "core/state_bytes.h"
#include "core/state_hash.h"
#include "core/time.h"

namespace slew::coupling {

class ParameterRamps {
 public:
  // parameters: greatest number of different handles.
  explicit ParameterRamps(std::size_t parameters) { ramps_.reserve(parameters); }

  // now: value of the parameter in the step before n. over: the line ends after its whole steps, at least one of a time
  // above 0; requests are rounded (scene::whole_steps).
  void begin(int handle, double now, double to, StepIndex n, SimDuration over, SimDuration step) noexcept {
    Ramp ramp{handle, now, to, n, over.ns > 0 ? std::max<StepIndex>(1, over.ns / step.ns) : 0};
    const auto under_way =
        std::find_if(ramps_.begin(), ramps_.end(), [&](const Ramp& r) { return r.handle == handle; });
    if (under_way != ramps_.end()) {
      // two changes in one step: the second one begins where the first did
      ramp.from = under_way->begin == n ? under_way->from : under_way->at(static_cast<double>(n - under_way->begin));
      *under_way = ramp;
      return;
    }
    SLEW_CHECK(ramps_.size() < ramps_.capacity());
    ramps_.push_back(ramp);
  }

  // Calls set(handle, value) for every current change; drops the changes that reached their target.
  template <typename Set>
  void apply(StepIndex n, Set&& set) noexcept {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < ramps_.size(); ++i) {
      const Ramp ramp = ramps_[i];
      const bool is_done = n - ramp.begin >= ramp.steps;
      set(ramp.handle, is_done ? ramp.to : ramp.at(static_cast<double>(n - ramp.begin) + 0.5));
      if (!is_done) ramps_[kept++] = ramp;
    }
    ramps_.resize(kept);
  }

  [[nodiscard]] bool is_under_way(int handle) const noexcept {
    return std::any_of(ramps_.begin(), ramps_.end(), [&](const Ramp& r) { return r.handle == handle; });
  }
  // Calls see(handle, to, steps) for every change under way with its steps from step n on.
  template <typename See>
  void follow(StepIndex n, See&& see) const {
    for (const Ramp& ramp : ramps_) see(ramp.handle, ramp.to, std::max<StepIndex>(1, ramp.begin + ramp.steps - n));
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

  void save(StateWriter& bytes) const {
    bytes.count(ramps_.size(), ramps_.capacity());
    for (const Ramp& ramp : ramps_) visit(ramp, bytes);
  }
  // is_handle(handle): true if the owner has the parameter. Does not allocate.
  template <typename IsHandle>
  void load(StateReader& bytes, IsHandle&& is_handle) noexcept {
    std::size_t count = 0;
    bytes.count(count, ramps_.capacity());
    ramps_.clear();
    for (std::size_t i = 0; i < count && bytes.is_sound(); ++i) {
      Ramp ramp;
      visit(ramp, bytes);
      if (!is_handle(ramp.handle) || is_under_way(ramp.handle) || ramp.steps < 0) return bytes.refuse();
      ramps_.push_back(ramp);
    }
  }

 private:
  struct Ramp {
    int handle = 0;
    double from = 0, to = 0;
    StepIndex begin = 0, steps = 1;
    // t: in steps since the begin
    [[nodiscard]] double at(double t) const noexcept {
      const auto end = static_cast<double>(steps);
      return t >= end ? to : from + (to - from) * (t / end);
    }
  };
  template <typename AnyRamp, typename Bytes>
  static void visit(AnyRamp& ramp, Bytes& bytes) {
    bytes.number(ramp.handle);
    bytes.number(ramp.from);
    bytes.number(ramp.to);
    bytes.count(ramp.begin, kLastStep);
    bytes.count(ramp.steps, kLastStep);
  }
  std::vector<Ramp> ramps_;
};

}  // namespace slew::coupling
