// SPDX-License-Identifier: Apache-2.0
#include "plotting/svg_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <string_view>
#include <vector>

#include "core/escaped.h"
#include "plotting/axis.h"
#include "plotting/decimation.h"
#include "plotting/svg_elements.h"
#include "plotting/svg_text.h"

namespace slew::plotting {
namespace {

// distances in px
constexpr double kLeft = 66;
constexpr double kRight = 22;
constexpr double kTopMargin = 16;
constexpr double kTitleHeight = 24;
constexpr double kSubtitleHeight = 18;
constexpr double kTitleGap = 8;
constexpr double kHeadingRow = 20;
constexpr double kLegendRow = 18;
constexpr double kLegendGap = 8;  // to the plot area
constexpr double kPanelGap = 20;
constexpr double kTimeAxisHeight = 44;
constexpr double kSwatch = 18;  // line in front of a name
constexpr double kPixelsPerTimeTick = 95;
constexpr double kPixelsPerValueTick = 38;

struct Panel {
  std::string unit{};
  std::vector<const Series*> series{};
  std::string heading{};  // heading of the plot, in its first panel
  double legend_top = 0;  // y of the first legend row's base line
  double top = 0;         // y of the plot area
  Axis axis{};
  bool is_empty = true;  // no value that can be shown
};

// "m3/s2" with raised digits
std::string typeset_unit(std::string_view unit) {
  std::string out;
  for (std::size_t i = 0; i < unit.size(); ++i) {
    const bool follows_letter = i > 0 && std::isalpha(static_cast<unsigned char>(unit[i - 1])) != 0;
    if (follows_letter && unit[i] == '2') {
      out += "\u00b2";
    } else if (follows_letter && unit[i] == '3') {
      out += "\u00b3";
    } else {
      out += unit[i];
    }
  }
  return out;
}

class Picture {
 public:
  Picture(std::span<const Plot> plots, const PlotOptions& options)
      : options_(options), width_(std::max(options.width, 300.0)), panel_height_(std::max(options.panel_height, 60.0)) {
    for (const Plot& plot : plots) add_panels(plot);
    find_time_axis();
    lay_out();
  }

  std::string draw() {
    put_head(out_, width_, height_);
    if (!options_.title.empty()) {
      put(out_, "<text class=\"title\" x=\"{}\" y=\"{}\">{}</text>\n", kLeft, kTopMargin + 14, escaped(options_.title));
    }
    if (!options_.subtitle.empty()) {
      const double y = kTopMargin + (options_.title.empty() ? 0 : kTitleHeight) + 10;
      put(out_, "<text class=\"sub\" x=\"{}\" y=\"{}\">{}</text>\n", kLeft, y, escaped(options_.subtitle));
    }
    for (std::size_t i = 0; i < panels_.size(); ++i) draw_panel(panels_[i], i);
    draw_time_labels();
    out_ += "</svg>\n";
    return std::move(out_);
  }

 private:
  // panels of one unit of the plot
  void add_panels(const Plot& plot) {
    const auto first = static_cast<std::ptrdiff_t>(panels_.size());
    for (const Series& s : plot.series) {
      // the last panel of the unit, and behind it the next one
      auto next = panels_.end();
      while (next != panels_.begin() + first && std::prev(next)->unit != s.unit) --next;
      const bool is_new = next == panels_.begin() + first;
      if (is_new) next = panels_.end();
      const bool has_room = !is_new && std::prev(next)->series.size() < kMaxCurvesOfPanel;
      if (!has_room) next = std::next(panels_.insert(next, Panel{.unit = s.unit}));
      std::prev(next)->series.push_back(&s);
    }
    if (!plot.series.empty()) panels_[static_cast<std::size_t>(first)].heading = plot.title;
  }

  void find_time_axis() {
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    for (const Panel& panel : panels_) {
      for (const Series* s : panel.series) {
        for (const double t : s->time) {
          if (!is_shown(t)) continue;
          low = std::min(low, t);
          high = std::max(high, t);
        }
      }
    }
    if (low > high) low = high = 0;
    time_ = tight_axis(low, high, static_cast<int>(plot_width() / kPixelsPerTimeTick));
    for (Panel& panel : panels_) find_value_axis(panel);
  }

  void find_value_axis(Panel& panel) {
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    for (const Series* s : panel.series) {
      for (const double value : s->values) {
        if (!is_shown(value)) continue;
        low = std::min(low, value);
        high = std::max(high, value);
      }
    }
    panel.is_empty = low > high;
    if (panel.is_empty) low = high = 0;
    panel.axis = value_axis(low, high, static_cast<int>(panel_height_ / kPixelsPerValueTick));
  }

  // places of the legend's names: the next row begins where a name would leave the picture
  template <typename Place>
  double place_legend(const Panel& panel, const Place& place) const {
    double x = kLeft + unit_width(panel);
    double row = 0;
    for (std::size_t i = 0; i < panel.series.size(); ++i) {
      const double wanted = kSwatch + 6 + text_width(panel.series[i]->name) + 18;
      if (x + wanted - 18 > width_ - kRight && x > kLeft + unit_width(panel)) {
        x = kLeft + unit_width(panel);
        row += kLegendRow;
      }
      place(i, x, row);
      x += wanted;
    }
    return row + kLegendRow;
  }

  static double unit_width(const Panel& panel) {
    const double label = text_width(panel.unit) + (panel.axis.exponent != 0 ? text_width(" x 1000") : 0);
    return label > 0 ? label + 22 : 0;
  }

  void lay_out() {
    double y = kTopMargin;
    if (!options_.title.empty()) y += kTitleHeight;
    if (!options_.subtitle.empty()) y += kSubtitleHeight;
    if (y > kTopMargin) y += kTitleGap;
    for (Panel& panel : panels_) {
      if (!panel.heading.empty()) y += kHeadingRow;
      panel.legend_top = y + 12;
      y += place_legend(panel, [](std::size_t, double, double) {}) + kLegendGap;
      panel.top = y;
      y += panel_height_ + kPanelGap;
    }
    bottom_ = panels_.empty() ? y : y - kPanelGap;
    height_ = bottom_ + kTimeAxisHeight;
  }

  double plot_width() const { return width_ - kLeft - kRight; }
  double x_of(double time) const { return kLeft + plot_width() * time_.fraction(time); }
  double y_of(const Panel& panel, double value) const {
    return panel.top + panel_height_ * (1 - panel.axis.fraction(value));
  }

  void draw_panel(const Panel& panel, std::size_t number) {
    out_ += "<g>\n";
    if (!panel.heading.empty()) {
      put(out_, "<text class=\"heading\" x=\"{}\" y=\"{:.1f}\">{}</text>\n", kLeft, panel.legend_top - kHeadingRow,
          escaped(panel.heading));
    }
    put(out_, "<text class=\"unit\" x=\"{}\" y=\"{:.1f}\">{}{}</text>\n", kLeft, panel.legend_top,
        escaped(typeset_unit(panel.unit)), factor_text(panel.axis.exponent));
    draw_grid(panel);
    put(out_, "<clipPath id=\"p{}\"><rect x=\"{}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\"/></clipPath>\n",
        number, kLeft, panel.top - 1, plot_width() + 1, panel_height_ + 2);
    put(out_, "<g clip-path=\"url(#p{})\">\n", number);
    for (std::size_t i = 0; i < panel.series.size(); ++i) draw_curve(panel, i);
    out_ += "</g>\n";
    place_legend(panel, [&](std::size_t i, double x, double row) { draw_legend_entry(panel, i, x, row); });
    if (panel.is_empty) {
      put(out_, "<text class=\"sub mid\" x=\"{:.1f}\" y=\"{:.1f}\">no values</text>\n", kLeft + plot_width() / 2,
          panel.top + panel_height_ / 2 - 8);
    }
    out_ += "</g>\n";
  }

  void draw_grid(const Panel& panel) {
    for (const double tick : time_.ticks()) {
      put_line(out_, "grid", x_of(tick), panel.top, x_of(tick), panel.top + panel_height_);
    }
    for (const double tick : panel.axis.ticks()) {
      const double y = y_of(panel, tick);
      put_line(out_, tick == 0 ? "zero" : "grid", kLeft, y, width_ - kRight, y);
      put(out_, "<text class=\"tick end\" x=\"{}\" y=\"{:.1f}\">{}</text>\n", kLeft - 9, y + 4, panel.axis.label(tick));
    }
    put_line(out_, "axis", kLeft, panel.top, kLeft, panel.top + panel_height_);
    put_line(out_, "axis", kLeft, panel.top + panel_height_, width_ - kRight, panel.top + panel_height_);
  }

  static std::string_view colour(std::size_t i) { return colour_of(i); }
  static std::string_view dash(std::size_t i) { return i / kColours.size() % 2 == 1 ? " dash" : ""; }

  void draw_curve(const Panel& panel, std::size_t i) {
    const Series& series = *panel.series[i];
    const auto columns = static_cast<std::size_t>(plot_width());
    std::string path;
    for (const Polyline& part : decimate(series, time_.low, time_.high, columns)) {
      char command = 'M';
      for (const auto& [time, value] : part) {
        fmt::format_to(std::back_inserter(path), "{}{:.1f} {:.1f}", command, x_of(time), y_of(panel, value));
        command = 'L';
      }
      if (part.size() == 1) draw_dot(x_of(part[0].first), y_of(panel, part[0].second), colour(i));
    }
    if (path.empty()) return;
    put(out_, "<path class=\"curve{}\" stroke=\"{}\" d=\"{}\"><title>{}</title></path>\n", dash(i), colour(i), path,
        escaped(series.name));
  }

  void draw_dot(double x, double y, std::string_view fill) {
    put(out_, "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"2.4\" fill=\"{}\"/>\n", x, y, fill);
  }

  void draw_legend_entry(const Panel& panel, std::size_t i, double x, double row) {
    const double y = panel.legend_top + row;
    put(out_, "<path class=\"curve{}\" stroke=\"{}\" style=\"stroke-width:2.4\" d=\"M{:.1f} {:.1f}h{}\"/>", dash(i),
        colour(i), x, y - 4, kSwatch);
    put(out_, "<text x=\"{:.1f}\" y=\"{:.1f}\">{}</text>\n", x + kSwatch + 6, y, escaped(panel.series[i]->name));
  }

  void draw_time_labels() {
    for (const double tick : time_.ticks()) {
      put_line(out_, "axis", x_of(tick), bottom_, x_of(tick), bottom_ + 4);
      put(out_, "<text class=\"tick mid\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>\n", x_of(tick), bottom_ + 18,
          time_.label(tick));
    }
    put(out_, "<text class=\"mid\" x=\"{:.1f}\" y=\"{:.1f}\">time [s{}]</text>\n", kLeft + plot_width() / 2,
        bottom_ + 36, factor_text(time_.exponent));
  }

  const PlotOptions& options_;
  double width_;
  double panel_height_;
  double height_ = 0;
  double bottom_ = 0;  // y of the last panel's lower edge
  std::vector<Panel> panels_;
  Axis time_;
  std::string out_;
};

}  // namespace

std::string plot_svg(std::span<const Plot> plots, const PlotOptions& options) {
  return Picture(plots, options).draw();
}

std::string plot_svg(std::span<const Series> series, const PlotOptions& options) {
  const Plot plot = {"", {series.begin(), series.end()}};
  return plot_svg(std::span(&plot, 1), options);
}

}  // namespace slew::plotting
