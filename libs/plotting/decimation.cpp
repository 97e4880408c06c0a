// SPDX-License-Identifier: Apache-2.0
#include "plotting/decimation.h"

#include <algorithm>
#include <array>

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
