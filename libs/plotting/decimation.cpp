// SPDX-License-Identifier: Apache-2.0
#include "plotting/decimation.h"

#include <algorithm>
#include <array>
#include <limits>

namespace slew::plotting {
namespace {

// the samples of one pixel column
class Column {
 public:
  void add(std::size_t i, double value) {
    if (count_ == 0) first_ = smallest_ = largest_ = i;
    if (count_ == 0 || value < smallest_value_) {
      smallest_ = i;
      smallest_value_ = value;
    }
    if (count_ == 0 || value > largest_value_) {
      largest_ = i;
      largest_value_ = value;
    }
    last_ = i;
    ++count_;
  }

  // moves the significant samples to the line, in their order, and empties the column
  void move_to(Polyline& line, const Series& series) {
    if (count_ == 0) return;
    std::array<std::size_t, 4> kept = {first_, smallest_, largest_, last_};
    std::sort(kept.begin(), kept.end());
    const auto end = std::unique(kept.begin(), kept.end());
    for (auto it = kept.begin(); it != end; ++it) line.emplace_back(series.time[*it], series.values[*it]);
    count_ = 0;
  }

 private:
  std::size_t count_ = 0;
  std::size_t first_ = 0;
  std::size_t smallest_ = 0;
  std::size_t largest_ = 0;
  std::size_t last_ = 0;
  double smallest_value_ = 0;
  double largest_value_ = 0;
};

}  // namespace

namespace {

// Two samples for those of [from, to), which has at least two.
void add_bin(const Series& curve, std::size_t from, std::size_t to, Series& thinned) {
  std::size_t least = to, largest = to;
  bool has_gap = false;
  for (std::size_t i = from; i < to; ++i) {
    if (!is_shown(curve.values[i])) {
      has_gap = true;
      continue;
    }
    if (least == to || curve.values[i] < curve.values[least]) least = i;
    if (largest == to || curve.values[i] > curve.values[largest]) largest = i;
  }
  const double none = std::numeric_limits<double>::quiet_NaN();
  const bool has_value = least != to;
  const std::size_t first = std::min(least, largest), second = std::max(least, largest);
  thinned.time.push_back(curve.time[from]);
  thinned.values.push_back(has_value ? curve.values[first] : none);
  thinned.time.push_back(curve.time[from + (to - from) / 2]);
  thinned.values.push_back(has_value && !has_gap ? curve.values[second] : none);
}

Series thinned_by(const Series& curve, std::size_t bin) {
  Series thinned{curve.name, curve.unit, {}, {}, 0};
  const std::size_t size = size_of(curve);
  for (std::size_t from = 0; from < size;) {
    std::size_t to = from + 1;
    while (to < size && to - from < bin && curve.time[to] >= curve.time[to - 1]) ++to;
    if (to - from == 1) {
      thinned.time.push_back(curve.time[from]);
      thinned.values.push_back(curve.values[from]);
    } else {
      add_bin(curve, from, to, thinned);
    }
    from = to;
  }
  return thinned;
}

}  // namespace

std::size_t thin_out(std::span<Series> curves, std::size_t most_values) {
  std::size_t longest = 0;
  for (const Series& curve : curves) longest = std::max(longest, size_of(curve));
  const std::size_t bins = std::max<std::size_t>(1, most_values / 2);
  if (longest <= 2 * bins) return 1;
  // one bin for all, so that common times stay common
  const std::size_t bin = (longest + bins - 1) / bins;
  for (Series& curve : curves) curve = thinned_by(curve, bin);
  return bin;
}

std::vector<Polyline> decimate(const Series& series, double t_low, double t_high, std::size_t columns) {
  std::vector<Polyline> parts(1);
  Column column;
  std::ptrdiff_t current = -1;
  double last_time = t_low;
  const auto part = [&] {
    column.move_to(parts.back(), series);
    if (!parts.back().empty()) parts.emplace_back();
    current = -1;
  };
  const std::size_t size = std::min(series.time.size(), series.values.size());
  for (std::size_t i = 0; i < size; ++i) {
    const double time = series.time[i];
    const bool is_gap = !is_shown(series.values[i]) || !is_shown(time);
    if (is_gap || time < last_time) part();
    if (is_gap || time < t_low || time > t_high) continue;
    last_time = time;
    const double position = (time - t_low) / (t_high - t_low) * static_cast<double>(columns);
    const std::ptrdiff_t at = std::min(static_cast<std::ptrdiff_t>(position), static_cast<std::ptrdiff_t>(columns) - 1);
    if (at != current) column.move_to(parts.back(), series);
    current = at;
    column.add(i, series.values[i]);
  }
  column.move_to(parts.back(), series);
  if (parts.back().empty()) parts.pop_back();
  return parts;
}

}  // namespace slew::plotting
