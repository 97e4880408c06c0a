// SPDX-License-Identifier: Apache-2.0
#include "plotting/chart_svg.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/escaped.h"
#include "plotting/axis.h"
#include "plotting/svg_elements.h"
#include "plotting/svg_text.h"

namespace slew::plotting {
namespace {

// distances in px
constexpr double kChartLeft = 78, kChartRight = 28, kChartTop = 70, kChartBottom = 56;
constexpr double kChartLegendRow = 18, kChartSwatch = 18;
constexpr double kChartMark = 3.5;
constexpr double kPixelsPerXTick = 90, kPixelsPerYTick = 45;

class ChartPicture {
 public:
  explicit ChartPicture(const Chart& chart) : c_(chart) {
    top_ = kChartTop + place_legend([](std::size_t, double, double) {});
    right_ = std::max(c_.width, 300.0) - kChartRight;
    bottom_ = std::max(c_.height, 300.0) - kChartBottom;
    find_chart_axes();
  }

  std::string draw() {
    put_head(out_, right_ + kChartRight, bottom_ + kChartBottom);
    put(out_, "<text class=\"title\" x=\"{}\" y=\"30\">{}</text>\n", kChartLeft, escaped(c_.title));
    put(out_, "<text class=\"sub\" x=\"{}\" y=\"50\">{}</text>\n", kChartLeft, escaped(c_.subtitle));
    draw_axes();
    put(out_, "<clipPath id=\"plot\"><rect x=\"{}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\"/></clipPath>\n",
        kChartLeft - 1, top_ - 1, right_ - kChartLeft + 2, bottom_ - top_ + 2);
    for (std::size_t i = 0; i < c_.curves.size(); ++i) draw_chart_curve(i);
    place_legend([&](std::size_t i, double x, double y) { draw_legend_name(i, x, y); });
    out_ += "</svg>\n";
    return std::move(out_);
  }

 private:
  static bool is_finite(const ChartPoint& point) { return std::isfinite(point.x) && std::isfinite(point.y); }

  void find_chart_axes() {
    double x_low = std::numeric_limits<double>::infinity(), x_high = -x_low, y_low = x_low, y_high = -x_low;
    for (const ChartCurve& curve : c_.curves) {
      for (const ChartPoint& point : curve.points) {
        if (!is_finite(point)) continue;
        x_low = std::min(x_low, point.x);
        x_high = std::max(x_high, point.x);
        y_low = std::min(y_low, std::min(point.y, c_.y_most));
        y_high = std::max(y_high, std::min(point.y, c_.y_most));
      }
    }
    if (x_low > x_high) x_low = x_high = y_low = y_high = 0;
    x_ = value_axis(x_low, x_high, static_cast<int>((right_ - kChartLeft) / kPixelsPerXTick));
    y_ = value_axis(y_low, y_high, static_cast<int>((bottom_ - top_) / kPixelsPerYTick));
  }

  [[nodiscard]] double x_of(double value) const { return kChartLeft + (right_ - kChartLeft) * x_.fraction(value); }
  [[nodiscard]] double y_of(double value) const { return bottom_ - (bottom_ - top_) * y_.fraction(value); }

  void draw_axes() {
    for (const double tick : x_.ticks()) {
      put_line(out_, "grid", x_of(tick), top_, x_of(tick), bottom_);
      put(out_, "<text class=\"tick mid\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>\n", x_of(tick), bottom_ + 18,
          x_.label(tick));
    }
    for (const double tick : y_.ticks()) {
      put_line(out_, tick == 0 ? "zero" : "grid", kChartLeft, y_of(tick), right_, y_of(tick));
      put(out_, "<text class=\"tick end\" x=\"{}\" y=\"{:.1f}\">{}</text>\n", kChartLeft - 9, y_of(tick) + 4,
          y_.label(tick));
    }
    put_line(out_, "axis", kChartLeft, top_, kChartLeft, bottom_);
    put_line(out_, "axis", kChartLeft, bottom_, right_, bottom_);
    put(out_, "<text class=\"mid\" x=\"{:.1f}\" y=\"{:.1f}\">{}{}</text>\n", 0.5 * (kChartLeft + right_), bottom_ + 40,
        escaped(c_.x_label), factor_text(x_.exponent));
    put(out_, "<text class=\"mid\" transform=\"translate(22 {:.1f}) rotate(-90)\">{}{}</text>\n",
        0.5 * (top_ + bottom_), escaped(c_.y_label), factor_text(y_.exponent));
  }

  void draw_chart_curve(std::size_t i) {
    const ChartCurve& curve = c_.curves[i];
    std::string path;
    bool is_open = false;
    const bool has_marks = curve.look == CurveLook::marks;
    out_ += has_marks ? "<g>\n" : "<g clip-path=\"url(#plot)\">\n";
    for (const ChartPoint& point : curve.points) {
      if (is_finite(point) && has_marks) draw_mark(point, i);
      if (is_finite(point)) {
        fmt::format_to(std::back_inserter(path), "{}{:.1f} {:.1f}", is_open ? 'L' : 'M', x_of(point.x), y_of(point.y));
      }
      is_open = is_finite(point);
    }
    if (!has_marks && !path.empty()) {
      put(out_, "<path class=\"curve\" stroke=\"{}\"{} d=\"{}\"><title>{}</title></path>\n", colour_of(i),
          width_text(curve), path, escaped(curve.name));
    }
    out_ += "</g>\n";
  }

  static std::string_view width_text(const ChartCurve& curve) {
    return curve.look == CurveLook::wide_line ? " style=\"stroke-width:4;stroke-opacity:.45\"" : "";
  }

  void draw_mark(const ChartPoint& point, std::size_t i) {
    put(out_, "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{}\" fill=\"{}\">", x_of(point.x), y_of(point.y), kChartMark,
        colour_of(i));
    if (!point.tooltip.empty()) put(out_, "<title>{}</title>", escaped(point.tooltip));
    out_ += "</circle>";
    if (!point.label.empty()) {
      put(out_, "<text class=\"tick\" style=\"font-size:10px\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>",
          x_of(point.x) + kChartMark + 2, y_of(point.y) - 3, escaped(point.label));
    }
    out_ += '\n';
  }

  // places of the names, the next row where one would leave the picture; returns the height of all rows
  template <typename Place>
  double place_legend(const Place& place) const {
    double x = kChartLeft, row = 0;
    for (std::size_t i = 0; i < c_.curves.size(); ++i) {
      const double wanted = kChartSwatch + 6 + text_width(c_.curves[i].name) + 18;
      if (x + wanted > c_.width - kChartRight && x > kChartLeft) x = kChartLeft, row += kChartLegendRow;
      place(i, x, kChartTop + row + 4);
      x += wanted;
    }
    return row + kChartLegendRow;
  }

  void draw_legend_name(std::size_t i, double x, double y) {
    const ChartCurve& curve = c_.curves[i];
    if (curve.look == CurveLook::marks) {
      put(out_, "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{}\" fill=\"{}\"/>", x + kChartSwatch / 2, y - 4, kChartMark,
          colour_of(i));
    } else {
      put(out_, "<path class=\"curve\" stroke=\"{}\"{} d=\"M{:.1f} {:.1f}h{}\"/>", colour_of(i), width_text(curve), x,
          y - 4, kChartSwatch);
    }
    put(out_, "<text x=\"{:.1f}\" y=\"{:.1f}\">{}</text>\n", x + kChartSwatch + 6, y, escaped(curve.name));
  }

  const Chart& c_;
  double top_ = 0, right_ = 0, bottom_ = 0;
  Axis x_, y_;
  std::string out_;
};

}  // namespace

std::string chart_svg(const Chart& chart) {
  return ChartPicture(chart).draw();
}

}  // namespace slew::plotting
