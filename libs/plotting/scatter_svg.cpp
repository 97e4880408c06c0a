// SPDX-License-Identifier: Apache-2.0
#include "plotting/scatter_svg.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/escaped.h"
#include "plotting/svg_elements.h"
#include "plotting/svg_text.h"

namespace slew::plotting {
namespace {

// distances in px
constexpr double kScatterLeft = 78, kScatterRight = 110, kScatterTop = 84, kScatterBottom = 56;
constexpr double kScatterLegendRow = 18;
constexpr double kMarkRadius = 4.5;
constexpr int kFewDecades = 2;  // up to this many, 2 and 5 are labelled too

// Whole decades around the shown values; at least one.
struct LogAxis {
  int low = 0, high = 1;  // powers of ten
  [[nodiscard]] double fraction(double value) const { return (std::log10(value) - low) / (high - low); }
};

LogAxis axis_around(double smallest, double largest) {
  if (!(smallest > 0) || !(largest >= smallest) || !std::isfinite(largest)) return {};
  LogAxis axis{static_cast<int>(std::floor(std::log10(smallest))), static_cast<int>(std::ceil(std::log10(largest)))};
  if (axis.high == axis.low) ++axis.high;
  return axis;
}

std::string tick_text(double factor, int power) {
  if (power >= -2 && power <= 3) return fmt::format("{:g}", factor * std::pow(10.0, power));
  const std::string mantissa = factor == 1 ? "" : fmt::format("{:g}\u00b7", factor);
  return mantissa + power_of_ten(power);
}

class ScatterPicture {
 public:
  explicit ScatterPicture(const Scatter& scatter) : s_(scatter) {
    find_axes();
    right_ = s_.width - kScatterRight;
    bottom_ = s_.height - kScatterBottom;
  }

  std::string draw() {
    put_head(out_, s_.width, s_.height);
    put(out_, "<text class=\"title\" x=\"{}\" y=\"30\">{}</text>\n", kScatterLeft, escaped(s_.title));
    put(out_, "<text class=\"sub\" x=\"{}\" y=\"50\">{}</text>\n", kScatterLeft, escaped(s_.subtitle));
    draw_grid();
    if (s_.y_floor > 0) draw_floor();
    for (std::size_t i = 0; i < s_.groups.size(); ++i) draw_group(i);
    draw_legend();
    out_ += "</svg>\n";
    return std::move(out_);
  }

 private:
  static bool is_shown(const Mark& mark) {
    return mark.x > 0 && std::isfinite(mark.x) && mark.y >= 0 && std::isfinite(mark.y);
  }

  // a value of zero is drawn only when there is a floor
  [[nodiscard]] double shown_y(const Mark& mark) const { return std::max(mark.y, floor_); }
  [[nodiscard]] bool is_on_floor(const Mark& mark) const { return mark.y < s_.y_floor || mark.y == 0; }

  void find_axes() {
    double x_low = std::numeric_limits<double>::infinity(), x_high = 0, y_low = x_low, y_high = 0;
    for (const MarkGroup& group : s_.groups) {
      for (const Mark& mark : group.marks) {
        if (!is_shown(mark)) continue;
        x_low = std::min(x_low, mark.x);
        x_high = std::max(x_high, mark.x);
        if (mark.y > 0 && mark.y >= s_.y_floor) y_low = std::min(y_low, mark.y);
        y_high = std::max(y_high, mark.y);
      }
    }
    floor_ = s_.y_floor > 0 ? s_.y_floor : std::isfinite(y_low) ? y_low : 1;
    x_ = axis_around(x_low, x_high);
    y_ = axis_around(std::min(y_low, 0.5 * floor_), std::max(y_high, floor_));
  }

  [[nodiscard]] double x_of(double value) const { return kScatterLeft + (right_ - kScatterLeft) * x_.fraction(value); }
  [[nodiscard]] double y_of(double value) const { return bottom_ - (bottom_ - kScatterTop) * y_.fraction(value); }

  // draw(value, label) for every tick
  template <typename Draw>
  static void each_tick(const LogAxis& axis, const Draw& draw) {
    const bool has_few = axis.high - axis.low <= kFewDecades;
    for (int power = axis.low; power <= axis.high; ++power) {
      for (const double factor : {1.0, 2.0, 5.0}) {
        if (factor > 1 && (!has_few || power == axis.high)) continue;
        draw(factor * std::pow(10.0, power), tick_text(factor, power));
      }
    }
  }

  void draw_grid() {
    each_tick(x_, [this](double value, const std::string& label) {
      put_line(out_, "grid", x_of(value), kScatterTop, x_of(value), bottom_);
      put(out_, "<text class=\"tick mid\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>\n", x_of(value), bottom_ + 18, label);
    });
    each_tick(y_, [this](double value, const std::string& label) {
      put_line(out_, "grid", kScatterLeft, y_of(value), right_, y_of(value));
      put(out_, "<text class=\"tick end\" x=\"{}\" y=\"{:.1f}\">{}</text>\n", kScatterLeft - 9, y_of(value) + 4, label);
    });
    put_line(out_, "axis", kScatterLeft, kScatterTop, kScatterLeft, bottom_);
    put_line(out_, "axis", kScatterLeft, bottom_, right_, bottom_);
    put(out_, "<text class=\"mid\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>\n", 0.5 * (kScatterLeft + right_), bottom_ + 40,
        escaped(s_.x_label));
    const double middle = 0.5 * (kScatterTop + bottom_);
    put(out_, "<text class=\"mid\" x=\"18\" y=\"{0:.1f}\" transform=\"rotate(-90 18 {0:.1f})\">{1}</text>\n", middle,
        escaped(s_.y_label));
  }

  void draw_floor() {
    put_line(out_, "zero dash", kScatterLeft, y_of(s_.y_floor), right_, y_of(s_.y_floor));
    // the space below the floor is free for its label
    put(out_, "<text class=\"tick\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>\n", kScatterLeft + 6, y_of(s_.y_floor) + 13,
        escaped(s_.y_floor_label));
  }

  void draw_group(std::size_t i) {
    const MarkGroup& group = s_.groups[i];
    const std::string_view colour = colour_of(i);
    std::string path;
    for (const Mark& mark : group.marks) {
      if (!is_shown(mark)) continue;
      fmt::format_to(std::back_inserter(path), "{}{:.1f} {:.1f}", path.empty() ? 'M' : 'L', x_of(mark.x),
                     y_of(shown_y(mark)));
    }
    if (path.empty()) return;
    put(out_, "<path class=\"curve\" stroke=\"{}\" d=\"{}\"/>\n", colour, path);
    for (const Mark& mark : group.marks) {
      if (!is_shown(mark)) continue;
      const double x = x_of(mark.x), y = y_of(shown_y(mark));
      put(out_,
          "<circle class=\"mark\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{}\" fill=\"{}\" stroke=\"{}\" "
          "stroke-width=\"1.6\"><title>{}, {}: {:.4g}, {:.4g}</title></circle>\n",
          x, y, kMarkRadius, is_on_floor(mark) ? "#ffffff" : colour, colour, escaped(group.name), escaped(mark.label),
          mark.x, mark.y);
      put(out_, "<text class=\"tick\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>\n", x + 8, y - 6, escaped(mark.label));
    }
  }

  void draw_legend() {
    double x = kScatterLeft;
    const double y = kScatterTop - kScatterLegendRow + 4;
    for (std::size_t i = 0; i < s_.groups.size(); ++i) {
      put(out_, "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{}\" fill=\"{}\"/>", x + kMarkRadius, y - 4, kMarkRadius,
          colour_of(i));
      put(out_, "<text x=\"{:.1f}\" y=\"{:.1f}\">{}</text>\n", x + 16, y, escaped(s_.groups[i].name));
      x += 16 + text_width(s_.groups[i].name) + 18;
    }
  }

  const Scatter& s_;
  LogAxis x_, y_;
  double floor_ = 1;
  double right_ = 0, bottom_ = 0;
  std::string out_;
};

}  // namespace

std::string scatter_svg(const Scatter& scatter) {
  return ScatterPicture(scatter).draw();
}

}  // namespace slew::plotting
