// SPDX-License-Identifier: Apache-2.0
#include "scene/live_course.h"

#include <algorithm>
#include <limits>
#include <map>
#include <vector>

#include "hydraulics/live_rules.h"

namespace slew::scene {
namespace {

constexpr StepIndex kNever = std::numeric_limits<StepIndex>::max();

class Course {
 public:
  explicit Course(const hydraulics::HydraulicsDef& circuit) : rules_(circuit) {}

  void set(const std::string& path, double value) {
    if (double* const number = rules_.find(path)) *number = value;
  }

  void begin(const LiveChange& change, std::size_t index) {
    double* const number = rules_.find(change.path);
    if (number == nullptr) return;
    ramps_.insert_or_assign(change.path, Ramp{number, *number, change.value, change.step, change.steps, index});
  }

  // Last step of a ramp under way that ends first.
  [[nodiscard]] StepIndex next_end() const {
    StepIndex first = kNever;
    for (const auto& [path, ramp] : ramps_) first = std::min(first, ramp.last());
    return first;
  }

  // The values of step n.
  std::optional<BrokenRule> advance(StepIndex n) {
    for (auto& [path, ramp] : ramps_) {
      const double share = static_cast<double>(n - ramp.begin + 1) / static_cast<double>(ramp.steps);
      *ramp.number = n >= ramp.last() ? ramp.to : ramp.from + (ramp.to - ramp.from) * share;
    }
    std::optional<BrokenRule> broken;
    for (const auto& [path, ramp] : ramps_) {
      std::optional<Problem> problem = rules_.broken_rule_of(path);
      if (problem && (!broken || broken->change < ramp.change)) broken = {std::move(*problem), n, ramp.change};
    }
    std::erase_if(ramps_, [n](const auto& ramp) { return n >= ramp.second.last(); });
    return broken;
  }

 private:
  struct Ramp {
    double* number = nullptr;
    double from = 0, to = 0;
    StepIndex begin = 0, steps = 1;
    std::size_t change = 0;
    [[nodiscard]] StepIndex last() const noexcept { return begin + std::max<StepIndex>(1, steps) - 1; }
  };
  hydraulics::LiveRules rules_;
  std::map<std::string, Ramp> ramps_;  // by path
};

}  // namespace

std::optional<BrokenRule> find_broken_rule(const hydraulics::HydraulicsDef& circuit,
                                           std::span<const std::pair<std::string, double>> present,
                                           std::span<const LiveChange> changes) {
  Course course(circuit);
  for (const auto& [path, value] : present) course.set(path, value);
  std::size_t next = 0;
  StepIndex reached = -1;
  while (true) {
    const StepIndex change = next < changes.size() ? changes[next].step : kNever;
    const StepIndex end = course.next_end();
    if (change == kNever && end == kNever) return std::nullopt;
    // ramps that a change replaces are followed to the step before it
    StepIndex n = std::min(change, end);
    if (end != kNever && change <= end && change - 1 > reached) n = change - 1;
    for (; n == change && next < changes.size() && changes[next].step == n; ++next) course.begin(changes[next], next);
    if (std::optional<BrokenRule> broken = course.advance(n)) return broken;
    reached = n;
  }
}

}  // namespace slew::scene
