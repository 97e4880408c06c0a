// SPDX-License-Identifier: Apache-2.0
// Projection of a machine at rest onto a picture, along one of its axes.
#pragma once

#include <algorithm>
#include <limits>

#include "diagram/pen.h"
#include "math/vector3.h"

namespace slew::analysis {

using diagram::Point;

class Camera {
 public:
  // Unit vectors in Ground: to the right and up in the picture, and to the viewer.
  Camera(math::Vec3 right, math::Vec3 up) : right_(right), up_(up), to_viewer_(math::cross(right, up)) {}

  void hold(math::Vec3 point) noexcept {
    const double x = math::dot(point, right_), y = math::dot(point, up_);
    low_x_ = std::min(low_x_, x), high_x_ = std::max(high_x_, x);
    low_y_ = std::min(low_y_, y), high_y_ = std::max(high_y_, y);
  }
  // Fits what it holds into a width at a place [px], or into the greatest height; the height that it takes.
  double fit(double left, double top, double width, double most_height) noexcept {
    const double wide = high_x_ - low_x_, high = high_y_ - low_y_, extent = std::max(wide, high),
                 size = extent > kPoint ? extent : 1;
    const double share_x = std::max(wide, kLeast * size), share_y = std::max(high, kLeast * size);
    scale_ = std::min(width / share_x, most_height / share_y);
    left_ = left + (width - scale_ * wide) / 2;
    top_ = top + scale_ * (share_y - high) / 2;
    return scale_ * share_y;
  }
  [[nodiscard]] Point at(math::Vec3 point) const noexcept {
    return {left_ + scale_ * (math::dot(point, right_) - low_x_), top_ + scale_ * (high_y_ - math::dot(point, up_))};
  }
  [[nodiscard]] double depth(math::Vec3 point) const noexcept { return math::dot(point, to_viewer_); }
  // Share of a direction that points to the viewer, -1 .. 1 for a unit vector.
  [[nodiscard]] double facing(math::Vec3 direction) const noexcept { return math::dot(direction, to_viewer_); }
  // Larger side of what it holds [m].
  [[nodiscard]] double size() const noexcept { return std::max(high_x_ - low_x_, high_y_ - low_y_); }
  [[nodiscard]] double scale() const noexcept { return scale_; }  // px/m

 private:
  static constexpr double kPoint = 1e-6;  // m, below it there is but a point, shown in a picture of 1 m
  static constexpr double kLeast = 0.15;  // least height over the width, and the other way round
  math::Vec3 right_, up_, to_viewer_;
  double low_x_ = kFar, high_x_ = -kFar, low_y_ = kFar, high_y_ = -kFar;
  double scale_ = 1, left_ = 0, top_ = 0;

  static constexpr double kFar = std::numeric_limits<double>::infinity();
};

}  // namespace slew::analysis
