// SPDX-License-Identifier: Apache-2.0
// Effect of dead zone and ramp on an input's raw signal over one step.
//
// w(t): the raw value, 0 where |raw| is less than the dead zone
// r(t): follows w, |r'| <= most / H                                                                    (1)
// Both are straight in pieces, so that the mean of r over the step is exact.
#pragma once

#include <limits>
#include <span>

#include "core/signal.h"

namespace slew::io_node {

inline constexpr double kAnyChange = std::numeric_limits<double>::infinity();

struct ShapedStep {
  double raw_mean = 0;  // mean of the raw value, -1..1
  double mean = 0;      // mean of r, -1..1
  double end = 0;       // r at the end of the step
};

// raw: the whole step, values -1..1; most: largest change of r in a step; start: r at its begin. Real-time safe.
[[nodiscard]] ShapedStep shape_step(std::span<const SignalPiece> raw, double dead_zone, double most,
                                    double start) noexcept;

}  // namespace slew::io_node
