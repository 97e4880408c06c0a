// SPDX-License-Identifier: Apache-2.0
// Elements of symbols as SVG. Internal to the library.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>
#include <string_view>

namespace slew::diagram {

struct Point {
  double x = 0, y = 0;  // px
};

class Pen {
 public:
  void path(std::string_view d) { put("<path d=\"{}\"/>", d); }
  void dashed(std::string_view d) { put("<path class=\"pilot\" d=\"{}\"/>", d); }
  void filled(std::string_view d) { put("<path class=\"solid\" d=\"{}\"/>", d); }
  void line(Point a, Point b) { put("<path d=\"M{:g} {:g}L{:g} {:g}\"/>", a.x, a.y, b.x, b.y); }
  void circle(Point at, double r) { put("<circle cx=\"{:g}\" cy=\"{:g}\" r=\"{:g}\"/>", at.x, at.y, r); }
  void box(Point at, double width, double height) {
    put("<rect x=\"{:g}\" y=\"{:g}\" width=\"{:g}\" height=\"{:g}\"/>", at.x, at.y, width, height);
  }
  // Line of chain dots around parts of one unit.
  void envelope(Point at, double width, double height) {
    put("<rect class=\"unit-border\" x=\"{:g}\" y=\"{:g}\" width=\"{:g}\" height=\"{:g}\"/>", at.x, at.y, width,
        height);
  }
  // Line with a filled head at b.
  void arrow(Point a, Point b, double head = 6) {
    line(a, b);
    const double length = std::max(std::hypot(b.x - a.x, b.y - a.y), 1e-9);
    const double ux = (b.x - a.x) / length, uy = (b.y - a.y) / length, half = 0.42 * head;
    put("<path class=\"solid\" d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}L{:.1f} {:.1f}Z\"/>", b.x, b.y,
        b.x - head * ux - half * uy, b.y - head * uy + half * ux, b.x - head * ux + half * uy,
        b.y - head * uy - half * ux);
  }
  // Spring from a to b.
  void spring(Point a, Point b, double half = 4) {
    constexpr int kTurns = 5;
    const double length = std::max(std::hypot(b.x - a.x, b.y - a.y), 1e-9);
    const double ux = (b.x - a.x) / length, uy = (b.y - a.y) / length;
    std::string d = fmt::format("M{:.1f} {:.1f}", a.x, a.y);
    for (int i = 0; i < kTurns; ++i) {
      const double way = length * (i + 0.5) / kTurns, side = i % 2 == 0 ? half : -half;
      fmt::format_to(std::back_inserter(d), "L{:.1f} {:.1f}", a.x + way * ux - side * uy, a.y + way * uy + side * ux);
    }
    fmt::format_to(std::back_inserter(d), "L{:.1f} {:.1f}", b.x, b.y);
    path(d);
  }
  // Blocked port: a stub from a with a bar at its end, half a bar to either side.
  void blocked(Point a, double stub) {
    line(a, {a.x, a.y + stub});
    line({a.x - 4, a.y + stub}, {a.x + 4, a.y + stub});
  }
  // Throttle of two arcs about a vertical line.
  void throttle(Point at) {
    put("<path d=\"M{0:g} {2:g}Q{1:g} {3:g} {0:g} {4:g}\"/>", at.x - 8, at.x - 2, at.y - 8, at.y, at.y + 8);
    put("<path d=\"M{0:g} {2:g}Q{1:g} {3:g} {0:g} {4:g}\"/>", at.x + 8, at.x + 2, at.y - 8, at.y, at.y + 8);
  }
  // Ball above its seat, free for a flow upwards.
  void check(Point at) {
    circle({at.x, at.y - 1.5}, 5.5);
    put("<path d=\"M{:g} {:g}L{:g} {:g}L{:g} {:g}\"/>", at.x - 9, at.y - 3, at.x, at.y + 7, at.x + 9, at.y - 3);
  }
  // Diagonal of an adjustable part.
  void adjustable(Point a, Point b) { arrow(a, b, 5); }

  [[nodiscard]] std::string take() { return std::move(text_); }

 private:
  template <typename... Arguments>
  void put(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
    fmt::format_to(std::back_inserter(text_), format, std::forward<Arguments>(arguments)...);
  }
  std::string text_;
};

}  // namespace slew::diagram
