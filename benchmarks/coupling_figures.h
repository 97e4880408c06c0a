// SPDX-License-Identifier: Apache-2.0
// Errors over the communication step or over the indicator, on two logarithmic axes, as self-contained SVG.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace slew::benchmarks {

struct ErrorCurve {
  std::string name;
  int colour = 0;
  bool is_dashed = false;
  bool has_line = true, has_marks = true;
  std::vector<std::pair<double, double>> points{};  // both > 0
  std::vector<bool> is_flagged{};                   // per point: drawn open
};

struct LogLogPlot {
  std::string title, subtitle, x_label, y_label;
  double x_low = 0.08, x_high = 25;
  double y_low = 1e-7, y_high = 1e1;  // larger values are drawn at the edge
  std::vector<double> x_ticks = {0.1, 0.2, 0.5, 1, 2, 5, 10, 20};
  bool has_flags = true;  // has a note on the meaning of open circles
};

[[nodiscard]] std::string log_log_svg(const std::vector<ErrorCurve>& curves, const LogLogPlot& plot);

}  // namespace slew::benchmarks
