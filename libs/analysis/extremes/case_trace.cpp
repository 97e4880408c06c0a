// SPDX-License-Identifier: Apache-2.0
#include "analysis/extremes/case_trace.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <numbers>

namespace slew::analysis {
namespace {

constexpr StepIndex kLeastChanges = 5;  // of the sign of a swing, whose decay is measured

}  // namespace

double largest_difference(const CaseTrace& a, const CaseTrace& b) {
  double range = 0, largest = 0;
  for (std::size_t c = 0; c < b.columns; ++c) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (std::size_t i = c; i < b.values.size(); i += b.columns) {
      low = std::min(low, b.values[i]);
      high = std::max(high, b.values[i]);
    }
    range = std::max(range, high - low);
  }
  for (std::size_t i = 0; i < std::min(a.values.size(), b.values.size()); ++i) {
    const double one = std::fabs(a.values[i] - b.values[i]);
    if (!(one <= largest)) largest = one;
  }
  return range > 0 ? largest / range : largest;
}

std::optional<Swing> swing_after(const CaseTrace& kicked, const CaseTrace& quiet, StepIndex kick, StepIndex end,
                                 double H) {
  const auto columns = static_cast<StepIndex>(quiet.columns);
  end = std::min(end, std::min(std::ssize(kicked.values), std::ssize(quiet.values)) / columns);
  const auto at = [&](StepIndex step, StepIndex column) {
    const auto i = static_cast<std::size_t>(step * columns + column);
    return kicked.values[i] - quiet.values[i];
  };
  const auto largest = [&](StepIndex column, StepIndex from, StepIndex to) {
    double swing = 0;
    for (StepIndex i = from; i < to; ++i) swing = std::max(swing, std::fabs(at(i, column)));
    return swing;
  };
  StepIndex column = 0;
  for (StepIndex other = 1; other < columns; ++other) {
    if (largest(other, kick + 1, end) > largest(column, kick + 1, end)) column = other;
  }
  StepIndex changes = 0, first = 0, last = 0;
  for (StepIndex i = kick + 2; i < end; ++i) {
    if (at(i - 1, column) * at(i, column) >= 0) continue;
    if (changes++ == 0) first = i;
    last = i;
  }
  if (changes < kLeastChanges) return std::nullopt;
  const StepIndex period = 2 * (last - first) / (changes - 1);
  const double before = largest(column, kick + 1, kick + 1 + period), after = largest(column, end - period, end);
  if (!(after > 0)) return std::nullopt;
  return Swing{2 * std::numbers::pi / (static_cast<double>(period) * H),
               std::log(before / after) / (static_cast<double>(end - period - kick - 1) * H)};
}

bool has_same_bits(const CaseTrace& a, const CaseTrace& b) {
  const auto same = [](double x, double y) {
    return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y);
  };
  return std::equal(a.values.begin(), a.values.end(), b.values.begin(), b.values.end(), same) &&
         std::equal(a.last.begin(), a.last.end(), b.last.begin(), b.last.end(), same);
}

}  // namespace slew::analysis
