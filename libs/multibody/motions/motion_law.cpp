// SPDX-License-Identifier: Apache-2.0
#include "multibody/motions/motion_law.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "math/rotation.h"
#include "multibody/motions/motion_pieces.h"

namespace slew::multibody {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;  // rad

MotionValue harmonic_motion(const MotionLaw& law, double time) noexcept {
  // whole turns are removed before they cost digits
  const double turns = law.frequency * time;
  const auto [s, c] = math::sin_cos(kTurn * (turns - std::floor(turns)) + law.phase);
  const double omega = kTurn * law.frequency;
  return {law.offset + law.amplitude * s, law.amplitude * omega * c, -law.amplitude * omega * omega * s};
}

MotionValue ramp_motion(const MotionLaw& law, double time) noexcept {
  const double tau = (time - law.start) / law.duration;
  if (tau <= 0) return {law.from, 0, 0};
  if (tau >= 1) return {law.to, 0, 0};
  const double change = law.to - law.from, rest = 1 - tau;
  return {law.from + change * tau * tau * tau * (10 + tau * (6 * tau - 15)),
          change * 30 * tau * tau * rest * rest / law.duration,
          change * 60 * tau * rest * (rest - tau) / (law.duration * law.duration)};
}

// of a table that is held beyond its ends: constant there
std::vector<MotionJump> jumps_of(const math::CubicSpline& spline) {
  constexpr double kRounding = 1e-9;
  double largest = 0;
  for (const math::SplinePoint& point : spline.points) largest = std::max(largest, std::fabs(point.second));
  const math::SplinePoint &first = spline.points.front(), &last = spline.points.back();
  std::vector<MotionJump> jumps;
  if (std::fabs(first.second) > kRounding * largest) jumps.push_back({first.x, 0, first.second});
  if (std::fabs(last.second) > kRounding * largest) jumps.push_back({last.x, last.second, 0});
  return jumps;
}

}  // namespace

MotionValue evaluate(const MotionLaw& law, double time) noexcept {
  switch (law.shape) {
    case MotionShape::table: {
      const math::SplineValue value = math::value_at(law.spline, time);
      return {value.y, value.slope, value.second};
    }
    case MotionShape::harmonic:
      return harmonic_motion(law, time);
    case MotionShape::ramp:
      return ramp_motion(law, time);
    case MotionShape::speed:
      break;
  }
  MotionValue value{law.first + law.speed * time, law.speed, 0};
  if (law.spline.empty()) return value;
  const math::SplineValue more = math::value_at(law.spline, time);
  value.position += more.integral;
  value.speed += more.y;
  value.acceleration = more.slope;
  return value;
}

MotionValue evaluate(const MotionLaw& law, double time, double until) noexcept {
  MotionValue value = evaluate(law, time);
  for (const MotionJump& jump : law.jumps) {
    if (jump.is_at(time)) value.acceleration = jump.time < until - kSameInstant ? jump.behind : jump.before;
  }
  return value;
}

bool holds_at(const MotionLaw& law, double time) noexcept {
  if (!law.is_refused_outside || law.spline.empty()) return true;
  return time >= law.spline.points.front().x && time <= law.spline.points.back().x;
}

MotionLaw motion_law(const MotionDef& def, double start) {
  MotionLaw law;
  law.shape = def.shape;
  law.amplitude = def.amplitude;
  law.frequency = def.frequency;
  law.phase = def.phase;
  law.offset = given_or(def.offset, start - def.amplitude * math::sin_cos(def.phase).sin);
  law.from = given_or(def.from, start);
  law.to = def.to;
  law.start = def.start;
  law.duration = def.duration;
  law.speed = def.speed;
  law.is_refused_outside = def.ends == TableEnds::refused;
  if (!def.points.empty()) {
    const auto ends = def.ends == TableEnds::hold ? math::SplineEnds::level : math::SplineEnds::natural;
    law.spline = math::cubic_spline(def.points, ends);
  }
  law.first = start - (law.spline.empty() ? 0.0 : math::value_at(law.spline, 0).integral);
  const bool is_held = def.shape == MotionShape::table && def.ends == TableEnds::hold;
  if (is_held && !law.spline.empty()) law.jumps = jumps_of(law.spline);
  law.resolution = table_resolution(law);
  return law;
}

}  // namespace slew::multibody
