// SPDX-License-Identifier: Apache-2.0
#include "plotting/axis.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace slew::plotting {
namespace {

constexpr int kMostTicks = 100;             // limit in case of wrong arithmetic
constexpr double kNearZero = 0.25;          // a range that begins below this part of its end begins at zero
constexpr double kNearTick = 0.05;          // share of a step
constexpr double kSmallestSpan = 1e-9;      // share of the magnitude: below it, a curve is a constant with rounding
constexpr double kSmallestNumber = 1e-290;  // below it, ticks would lose their digits
constexpr double kLargestPlainLabel = 1e5;
constexpr double kSmallestPlainLabel = 1e-3;

double nice_step(double span, int about_ticks) {
  const double rough = span / std::max(about_ticks, 1);
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  const double mantissa = rough / power;
  const double nice = mantissa < 1.5 ? 1 : mantissa < 3.5 ? 2 : mantissa < 7.5 ? 5 : 10;
  return nice * power;
}

// a constant gets a range around it
void widen(double& low, double& high) {
  const double magnitude = std::max(std::abs(low), std::abs(high));
  if (high - low > kSmallestSpan * magnitude && high - low > kSmallestNumber) return;
  const double margin = magnitude > kSmallestNumber ? 0.1 * magnitude : 1;
  low -= margin;
  high += margin;
}

// the axis label takes factors of a thousand
int exponent_of(const Axis& axis) {
  const double largest = std::max(std::abs(axis.low), std::abs(axis.high));
  if (largest < kLargestPlainLabel && largest >= kSmallestPlainLabel) return 0;
  return 3 * static_cast<int>(std::floor(std::log10(largest) / 3));
}

}  // namespace

std::vector<double> Axis::ticks() const {
  std::vector<double> ticks;
  // by integer multiples, so that rounding does not add up
  const double first = std::ceil(low / step - 1e-6);
  for (int i = 0; i < kMostTicks; ++i) {
    const double tick = (first + i) * step;
    if (tick > high + 1e-6 * step) break;
    ticks.push_back(tick == 0 ? 0 : tick);
  }
  return ticks;
}

std::string Axis::label(double tick) const {
  if (tick == 0) return "0";
  const double scale = std::pow(10.0, exponent);
  const int digits = std::clamp(-static_cast<int>(std::floor(std::log10(step / scale) + 1e-9)), 0, 9);
  std::string text = fmt::format("{:.{}f}", std::abs(tick) / scale, digits);
  return tick < 0 ? "\u2212" + text : text;
}

Axis value_axis(double low, double high, int about_ticks) {
  if (low > 0 && low < kNearZero * high) low = 0;
  if (high < 0 && high > kNearZero * low) high = 0;
  widen(low, high);
  Axis axis;
  axis.step = nice_step(high - low, about_ticks);
  axis.low = std::floor(low / axis.step + 1e-9) * axis.step;
  axis.high = std::ceil(high / axis.step - 1e-9) * axis.step;
  axis.exponent = exponent_of(axis);
  return axis;
}

Axis tight_axis(double low, double high, int about_ticks) {
  if (!(high > low)) high = low + 1;
  Axis axis;
  axis.low = low;
  axis.high = high;
  axis.step = nice_step(high - low, about_ticks);
  // a record that ends one sample in front of a tick ends at it
  const double next_tick = std::ceil(high / axis.step) * axis.step;
  if (next_tick - high < kNearTick * axis.step) axis.high = next_tick;
  axis.exponent = exponent_of(axis);
  return axis;
}

}  // namespace slew::plotting
