// SPDX-License-Identifier: Apache-2.0
#include "plotting/series.h"

#include <algorithm>
#include <iterator>
#include <limits>

namespace slew::plotting {
namespace {

constexpr double kLongestSpacing =
    1.5;  // in spacings; more: a sample is missing, with a margin for the rounding of times

std::vector<double> sorted_instants(const Series& curve) {
  std::vector<double> instants = curve.time;
  std::sort(instants.begin(), instants.end());
  instants.erase(std::unique(instants.begin(), instants.end()), instants.end());
  return instants;
}

}  // namespace

std::size_t size_of(const Series& curve) noexcept {
  return std::min(curve.time.size(), curve.values.size());
}

void keep_common_instants(std::span<Series> curves) {
  if (curves.empty()) return;
  std::vector<double> common = sorted_instants(curves.front());
  for (const Series& curve : curves.subspan(1)) {
    const std::vector<double> own = sorted_instants(curve);
    std::vector<double> both;
    std::set_intersection(common.begin(), common.end(), own.begin(), own.end(), std::back_inserter(both));
    common = std::move(both);
  }
  for (Series& curve : curves) {
    Series kept{curve.name, curve.unit, {}, {}, curve.spacing};
    std::vector<bool> is_taken(common.size(), false);
    for (std::size_t i = 0; i < curve.time.size(); ++i) {
      const auto at = std::lower_bound(common.begin(), common.end(), curve.time[i]);
      if (at == common.end() || *at != curve.time[i]) continue;
      const auto place = static_cast<std::size_t>(at - common.begin());
      if (is_taken[place]) continue;
      is_taken[place] = true;
      kept.time.push_back(curve.time[i]);
      kept.values.push_back(curve.values[i]);
    }
    curve = std::move(kept);
  }
}

bool is_gap(const Series& curve, std::size_t i) noexcept {
  return curve.spacing > 0 && curve.time[i] - curve.time[i - 1] > kLongestSpacing * curve.spacing;
}

void part_at_gaps(std::span<Series> curves) {
  for (Series& curve : curves) {
    Series parted{curve.name, curve.unit, {}, {}, curve.spacing};
    for (std::size_t i = 0; i < curve.time.size(); ++i) {
      if (i > 0 && is_gap(curve, i)) {
        parted.time.push_back(curve.time[i - 1] + curve.spacing);
        parted.values.push_back(std::numeric_limits<double>::quiet_NaN());
      }
      parted.time.push_back(curve.time[i]);
      parted.values.push_back(curve.values[i]);
    }
    curve = std::move(parted);
  }
}

}  // namespace slew::plotting
