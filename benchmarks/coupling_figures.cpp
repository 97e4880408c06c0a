// SPDX-License-Identifier: Apache-2.0
#include "benchmarks/coupling_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

namespace slew::benchmarks {
namespace {

// px
constexpr double kLeft = 70, kTop = 66, kWidth = 560, kHeight = 400, kRight = 230, kBottom = 56;
constexpr std::array<std::string_view, 5> kColours = {"#1b6ca8", "#2a9d5c", "#b8327a", "#d95f02", "#9aa2aa"};
constexpr std::string_view kStyle =
    "text{font-family:Inter,'Helvetica Neue',Arial,'DejaVu Sans',sans-serif;font-size:12px;fill:#3c434b}"
    ".title{font-size:17px;font-weight:600;fill:#1d2227}.sub{fill:#6a727b}.end{text-anchor:end}.mid{text-anchor:middle}"
    ".grid{stroke:#e7eaed;stroke-width:1}.axis{stroke:#8a929a;stroke-width:1;fill:none}"
    ".curve{fill:none;stroke-width:1.8}.dash{stroke-dasharray:6 4}";

class Frame {
 public:
  explicit Frame(const LogLogPlot& plot) : plot_(plot) {}
  [[nodiscard]] double x(double value) const {
    return kLeft + kWidth * std::log(value / plot_.x_low) / std::log(plot_.x_high / plot_.x_low);
  }
  [[nodiscard]] double y(double value) const {
    const double shown = std::clamp(value, plot_.y_low, plot_.y_high);
    return kTop + kHeight * (1 - std::log(shown / plot_.y_low) / std::log(plot_.y_high / plot_.y_low));
  }

 private:
  const LogLogPlot& plot_;
};

std::string grid(const LogLogPlot& plot, const Frame& frame) {
  std::string svg;
  for (const double step : plot.x_ticks) {
    const double x = frame.x(step);
    svg += fmt::format("<line class='grid' x1='{0:.1f}' x2='{0:.1f}' y1='{1}' y2='{2}'/>", x, kTop, kTop + kHeight);
    svg += fmt::format("<text class='mid' x='{:.1f}' y='{}'>{}</text>", x, kTop + kHeight + 18, step);
  }
  for (double decade = plot.y_low; decade < plot.y_high * 1.5; decade *= 10) {
    const double y = frame.y(decade);
    svg += fmt::format("<line class='grid' x1='{1}' x2='{2}' y1='{0:.1f}' y2='{0:.1f}'/>", y, kLeft, kLeft + kWidth);
    const int exponent = static_cast<int>(std::lround(std::log10(decade)));
    svg += fmt::format("<text class='end' x='{}' y='{:.1f}'>1e{}</text>", kLeft - 8, y + 4, exponent);
  }
  return svg;
}

std::string curve_of(const ErrorCurve& curve, const Frame& frame) {
  const std::string_view colour = kColours[static_cast<std::size_t>(curve.colour) % kColours.size()];
  std::string path, marks;
  for (std::size_t i = 0; i < curve.points.size(); ++i) {
    const double x = frame.x(curve.points[i].first), y = frame.y(curve.points[i].second);
    path += fmt::format("{}{:.1f},{:.1f} ", i == 0 ? "M" : "L", x, y);
    marks += fmt::format("<circle cx='{:.1f}' cy='{:.1f}' r='4' stroke='{}' stroke-width='1.6' fill='{}'/>", x, y,
                         colour, curve.is_flagged[i] ? "#ffffff" : colour);
  }
  if (!curve.has_marks) marks.clear();
  if (!curve.has_line) return marks;
  return fmt::format("<path class='curve{}' stroke='{}' d='{}'/>", curve.is_dashed ? " dash" : "", colour, path) +
         marks;
}

}  // namespace

std::string log_log_svg(const std::vector<ErrorCurve>& curves, const LogLogPlot& plot) {
  const Frame frame(plot);
  const double width = kLeft + kWidth + kRight, height = kTop + kHeight + kBottom;
  std::string svg = fmt::format(
      "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {0} {1}' width='{0}' height='{1}'><style>{2}</style>"
      "<rect width='{0}' height='{1}' fill='#ffffff'/>",
      width, height, kStyle);
  svg += fmt::format("<text class='title' x='{}' y='26'>{}</text><text class='sub' x='{}' y='46'>{}</text>", kLeft,
                     plot.title, kLeft, plot.subtitle);
  svg += grid(plot, frame);
  svg += fmt::format("<rect class='axis' x='{}' y='{}' width='{}' height='{}'/>", kLeft, kTop, kWidth, kHeight);
  for (const ErrorCurve& curve : curves) svg += curve_of(curve, frame);
  for (std::size_t i = 0; i < curves.size(); ++i) {
    const double y = kTop + 14 + 22 * static_cast<double>(i), x = kLeft + kWidth + 16;
    const std::string_view colour = kColours[static_cast<std::size_t>(curves[i].colour) % kColours.size()];
    if (curves[i].has_line) {
      svg += fmt::format("<path class='curve{}' stroke='{}' d='M{},{} l26,0'/>", curves[i].is_dashed ? " dash" : "",
                         colour, x, y);
    } else {
      svg += fmt::format("<circle cx='{}' cy='{}' r='4' fill='{}'/>", x + 13, y, colour);
    }
    svg += fmt::format("<text x='{}' y='{}'>{}</text>", x + 34, y + 4, curves[i].name);
  }
  if (plot.has_flags) {
    svg += fmt::format("<text x='{}' y='{}'>open circle: flagged as</text><text x='{}' y='{}'>creating energy</text>",
                       kLeft + kWidth + 16, kTop + kHeight - 20, kLeft + kWidth + 16, kTop + kHeight - 4);
  }
  svg +=
      fmt::format("<text class='mid' x='{}' y='{}'>{}</text>", kLeft + kWidth / 2, kTop + kHeight + 42, plot.x_label);
  svg += fmt::format("<text class='mid' transform='translate(18,{}) rotate(-90)'>{}</text></svg>\n", kTop + kHeight / 2,
                     plot.y_label);
  return svg;
}

}  // namespace slew::benchmarks
