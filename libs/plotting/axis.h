// SPDX-License-Identifier: Apache-2.0
// Ticks of an axis: steps of 1, 2 or 5 times a power of ten, labelled with as many digits as the step needs.
#pragma once

#include <string>
#include <vector>

namespace slew::plotting {

struct Axis {
  double low = 0;  // shown range, low < high
  double high = 1;
  double step = 1;   // between ticks
  int exponent = 0;  // labels are in units of 10^exponent; 0 where plain numbers are readable

  [[nodiscard]] double fraction(double value) const noexcept { return (value - low) / (high - low); }
  [[nodiscard]] std::vector<double> ticks() const;
  // "-2.5", with the typographic minus.
  [[nodiscard]] std::string label(double tick) const;
};

// Range for values between low and high with about the given number of ticks. The range ends at ticks, contains zero
// when that is close, and is never empty. Pre-condition: both finite, low <= high.
[[nodiscard]] Axis value_axis(double low, double high, int about_ticks);

// Range from low to high, or to the next tick when that is close behind; for time.
[[nodiscard]] Axis tight_axis(double low, double high, int about_ticks);

}  // namespace slew::plotting
