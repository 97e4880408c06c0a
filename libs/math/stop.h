// SPDX-License-Identifier: Apache-2.0
// Two-sided stop along a coordinate x with speed v: a spring and a damper behind each limit, which push and never pull.
//
//   F = max(0, k (x_min - x) - c v) - max(0, k (x - x_max) + c v)                                             (1)
// the first term while x < x_min, the second while x > x_max, else 0. Any consistent units.
#pragma once

namespace slew::math {

struct StopForce {
  double force = 0, d_x = 0, d_v = 0;  // F and its slopes
};

[[nodiscard]] inline StopForce stop_force(double x, double v, double x_min, double x_max, double k, double c) noexcept {
  // sign of the direction in which depth and its rate grow
  const double side = x < x_min ? -1.0 : x > x_max ? 1.0 : 0.0;
  if (side == 0) return {};
  const double push = k * (side < 0 ? x_min - x : x - x_max) + side * c * v;
  if (!(push > 0)) return {};
  return {-side * push, -k, -c};
}

}  // namespace slew::math
