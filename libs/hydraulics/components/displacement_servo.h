// SPDX-License-Identifier: Apache-2.0
// The servo that sets the displacement of a pump or motor: a lag with a greatest rate.
//
//   e' = sat((command - e) / tau, r),   sat(x, r) = sgn(x) min(|x|, r)                              (1)
// e share of the displacement, tau time constant [s], r greatest rate [1/s], 0: none. The corner of min is smooth over
// a twentieth of r, where |e'| exceeds r by at most 0.8 %.
#pragma once

#include <cmath>

#include "hydraulics/smooth.h"

namespace slew::hydraulics {

inline constexpr double kServoCorner = 0.05;  // share of the greatest rate

// (1) and its slope over the error, command - e.
[[nodiscard]] inline ValueSlope servo_rate(double error, double time_constant, double rate_limit) noexcept {
  const double x = error / time_constant;
  if (rate_limit == 0) return {x, 1 / time_constant};
  const ValueSlope least = smooth_min(std::fabs(x), rate_limit, kServoCorner * rate_limit);
  return {std::copysign(least.value, x), least.slope / time_constant};
}

}  // namespace slew::hydraulics
