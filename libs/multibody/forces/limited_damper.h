// SPDX-License-Identifier: Apache-2.0
// A damper beside a spring that only pushes, or only pulls: it carries at most what the spring does.
//
//   F = F_s + min(F_s, max(-F_s, F_d)) while F_s > 0, else 0                                          (1)
// so that the force begins and ends at zero without a jump, never changes its sign, and the damper only takes energy.
#pragma once

#include <algorithm>

namespace slew::multibody {

struct LimitedForce {
  double force = 0;
  // how often the spring's slope counts, 0, 1 or 2: the damper takes all of the force away, is free, is at its limit
  int springs = 0;
};

[[nodiscard]] inline LimitedForce limited_force(double spring, double damper) noexcept {
  if (!(spring > 0) || damper <= -spring) return {};
  return {spring + std::min(spring, damper), damper < spring ? 1 : 2};
}

}  // namespace slew::multibody
