// SPDX-License-Identifier: Apache-2.0
#include "flex/mode_shape_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace slew::flex {

using math::Vec3;

namespace {

constexpr double kTitle = 52;        // px above the panels
constexpr double kGap = 16;          // px between panels
constexpr double kHead = 30;         // px of a panel's caption
constexpr double kLeft = 44;         // px left of a plot, for the plane's name
constexpr double kAmplitude = 0.36;  // share of a plane's height

// frame of the drawing: middle of the nodes, half of the length, and the longest axis
struct Frame {
  Vec3 middle;
  double half = 0;
  int along = 0;
};

Frame frame_of(const ReducedBody& body) {
  Vec3 low = body.nodes.front().position, high = low;
  for (const ReducedNode& node : body.nodes) {
    for (int a = 0; a < 3; ++a) {
      low.lanes[a] = std::min(low[a], node.position[a]);
      high.lanes[a] = std::max(high[a], node.position[a]);
    }
  }
  const Vec3 size = high - low;
  const int along = size[0] >= size[1] && size[0] >= size[2] ? 0 : size[1] >= size[2] ? 1 : 2;
  return {(low + high) * 0.5, size[along] / 2, along};
}

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else
      out += c;
  }
  return out;
}

// Drawing of a mode: displacements, or without any the turn about one axis as a height.
struct Kind {
  double largest = 0;    // largest drawn value
  int turns_about = -1;  // axis, or -1: displacements
  std::string words;
};

// the axis of the largest displacement, or of the turn
Kind kind_of(const ReducedBody& body, std::size_t mode, double size) {
  Vec3 moved, turned;
  double largest = 0, largest_turn = 0;
  for (const ReducedNode& node : body.nodes) {
    for (int a = 0; a < 3; ++a) {
      moved.lanes[a] += node.phi[mode][a] * node.phi[mode][a];
      turned.lanes[a] += node.psi[mode][a] * node.psi[mode][a];
    }
    largest = std::max(largest, norm(node.phi[mode]));
    largest_turn = std::max(largest_turn, norm(node.psi[mode]));
  }
  const auto strongest = [](Vec3 v) { return v[0] >= v[1] && v[0] >= v[2] ? 0 : v[1] >= v[2] ? 1 : 2; };
  const double sum = moved[0] + moved[1] + moved[2], turning = (turned[0] + turned[1] + turned[2]) * size * size;
  const int axis = strongest(turned);
  if (sum < 1e-12 * turning) return {largest_turn, axis, fmt::format("turns about {}", "xyz"[axis])};
  return {largest, -1, fmt::format("moves along {}", "xyz"[strongest(moved)])};
}

class PlotPlane {
 public:
  // px: middle of the plane, half of its width, its height; across: the axis that points up
  PlotPlane(const Frame& frame, double x, double y, double half_width, double height, int across)
      : frame_(frame), x_(x), y_(y), scale_(half_width / frame.half), height_(height), across_(across) {}

  void draw(std::string& svg, const ReducedBody& body, std::size_t mode, const Kind& kind) const {
    const std::string axes = fmt::format("{}-{}", "xyz"[frame_.along], "xyz"[across_]);
    label(svg, x_ - scale_ * frame_.half - 12, y_ + 4, "end", kind.turns_about < 0 ? axes : "turn");
    line(svg, body, mode, 0, kind, "rest");
    line(svg, body, mode, kind.largest > 0 ? kAmplitude * height_ / kind.largest : 0, kind, "moved");
    for (const ReducedNode* node : {&body.nodes.front(), &body.nodes.back()}) {
      const Vec3 p = node->position - frame_.middle;
      label(svg, x_ + scale_ * p[frame_.along], y_ - scale_ * p[across_] + 16, "middle", std::to_string(node->id));
    }
  }

 private:
  static void label(std::string& svg, double x, double y, const char* anchor, const std::string& text) {
    fmt::format_to(std::back_inserter(svg), "<text x='{:.1f}' y='{:.1f}' class='axis' text-anchor='{}'>{}</text>\n", x,
                   y, anchor, text);
  }

  // amplitude: px per unit of the mode
  void line(std::string& svg, const ReducedBody& body, std::size_t mode, double amplitude, const Kind& kind,
            const char* style) const {
    fmt::format_to(std::back_inserter(svg), "<polyline class='{}' points='", style);
    std::string dots;
    for (const ReducedNode& node : body.nodes) {
      const Vec3 p = node.position - frame_.middle;
      const Vec3 u = kind.turns_about < 0 ? node.phi[mode] : Vec3();
      const double up = kind.turns_about < 0 ? u[across_] : node.psi[mode][kind.turns_about];
      const double x = x_ + scale_ * p[frame_.along] + amplitude * u[frame_.along];
      const double y = y_ - scale_ * p[across_] - amplitude * up;
      fmt::format_to(std::back_inserter(svg), "{:.1f},{:.1f} ", x, y);
      fmt::format_to(std::back_inserter(dots), "<circle class='{}-dot' cx='{:.1f}' cy='{:.1f}' r='{}'/>\n", style, x, y,
                     amplitude == 0 ? 1.2 : 1.8);
    }
    svg += "'/>\n" + dots;
  }

  const Frame& frame_;
  double x_, y_, scale_, height_;
  int across_;
};

const char* kStyle =
    "<style>text{font-family:Helvetica,Arial,sans-serif;fill:#222}.title{font-size:16px;font-weight:bold}"
    ".sub{font-size:12px;fill:#666}.caption{font-size:13px;font-weight:bold}.axis{font-size:11px;fill:#666}"
    ".box{fill:#fff;stroke:#ccc}.rest{fill:none;stroke:#999;stroke-width:1;stroke-dasharray:4 3}.rest-dot{fill:#999}"
    ".moved{fill:none;stroke:#0b62a4;stroke-width:2}.moved-dot{fill:#0b62a4}</style>\n";

}  // namespace

std::string mode_shape_svg(const Reduction& reduction, std::span<const int> ordinals,
                           const ModeShapePlotOptions& options) {
  const ReducedBody& body = reduction.body;
  (void)places_of(ordinals, body.modes());
  const int count = static_cast<int>(ordinals.size()), columns = std::clamp(options.columns, 1, std::max(count, 1));
  const int rows = (count + columns - 1) / columns;
  const double width = kGap + columns * (options.panel_width + kGap);
  const double height = kTitle + rows * (options.panel_height + kGap);
  const std::string title = options.title.empty() ? reduction.source.model + ": mode shapes" : options.title;
  std::string svg = fmt::format(
      "<svg xmlns='http://www.w3.org/2000/svg' width='{0:.0f}' height='{1:.0f}' viewBox='0 0 {0:.0f} {1:.0f}'>\n{2}"
      "<rect width='100%' height='100%' fill='#fff'/>\n<text x='{3:.0f}' y='24' class='title'>{4}</text>\n"
      "<text x='{3:.0f}' y='42' class='sub'>{5}; dashed: undeformed; deflections not to scale</text>\n",
      width, height, kStyle, kGap, escaped(title), escaped(reduction.source.made_of));
  const Frame frame = frame_of(body);
  for (int i = 0; i < count; ++i) {
    const auto mode = static_cast<std::size_t>(ordinals[static_cast<std::size_t>(i)] - 1);
    const double left = kGap + (i % columns) * (options.panel_width + kGap);
    const double top = kTitle + (i / columns) * (options.panel_height + kGap);
    const Kind kind = kind_of(body, mode, frame.half);
    fmt::format_to(std::back_inserter(svg),
                   "<rect class='box' x='{:.1f}' y='{:.1f}' width='{:.1f}' height='{:.1f}'/>\n"
                   "<text x='{:.1f}' y='{:.1f}' class='caption'>Mode {}: {:.4g} Hz, {}</text>\n",
                   left, top, options.panel_width, options.panel_height, left + 12, top + 20, mode + 1,
                   body.omega[mode] / (2 * M_PI), kind.words);
    const double plane_height = (options.panel_height - kHead) / 2, half = (options.panel_width - kLeft - 36) / 2;
    // a turn has one height, drawn once
    for (int plane = 0; plane < (kind.turns_about < 0 ? 2 : 1); ++plane) {
      const int across = plane == 0 ? (frame.along == 1 ? 2 : 1) : (frame.along == 0 ? 2 : 0);
      const double middle = top + kHead + (plane + 0.5) * plane_height;
      PlotPlane(frame, left + kLeft + 8 + half, middle, half, plane_height, across).draw(svg, body, mode, kind);
    }
  }
  return svg + "</svg>\n";
}

}  // namespace slew::flex
