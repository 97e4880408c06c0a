// SPDX-License-Identifier: Apache-2.0
// A coordinate as a function of time, with its speed and its acceleration.
//
//   table     x = cubic spline through the points (math/cubic_spline.h)                              (1)
//   harmonic  x = offset + amplitude sin(2 pi f t + phase)                                           (2)
//   ramp      x = from + (to - from) s(tau),  s = 10 tau^3 - 15 tau^4 + 6 tau^5,  tau = (t - start)/duration
//             between 0 and 1: speed and acceleration are zero at both ends                           (3)
//   speed     x = x(0) + speed t + integral of the spline through the points, from 0 to t             (4)
// t [s] is the session's time. Speeds and accelerations are the exact derivatives. The acceleration of (1) with
// `ends: hold` jumps at the first and the last point; no speed does. Not covered: motion that depends on anything but
// time, and motion that an input gives.
#pragma once

#include <cmath>
#include <limits>
#include <vector>

#include "math/cubic_spline.h"
#include "multibody/motions/motion_defs.h"

namespace slew::multibody {

inline constexpr double kNever = std::numeric_limits<double>::infinity();  // s

// Instants closer than this to a jump of an acceleration are at it: less than the session's clock resolves, more than
// the rounding of ten days.
inline constexpr double kSameInstant = 3e-10;  // s

// A jump of the acceleration.
struct MotionJump {
  double time = 0;                // s
  double before = 0, behind = 0;  // one-sided accelerations, rad/s2 or m/s2
  [[nodiscard]] bool is_at(double instant) const noexcept { return std::fabs(instant - time) <= kSameInstant; }
};

struct MotionLaw {
  MotionShape shape = MotionShape::table;
  math::CubicSpline spline;                          // (1), (4)
  double offset = 0, amplitude = 0;                  // rad or m
  double frequency = 0, phase = 0;                   // Hz, rad
  double from = 0, to = 0, start = 0, duration = 1;  // rad or m, s
  double speed = 0;                                  // rad/s or m/s
  double first = 0;                                  // x(0) of (4), less the spline's integral there
  std::vector<MotionJump> jumps;                     // in the order of time
  std::vector<double> resolution;                    // s, longest sub-steps by interval (motion_pieces.h)
  bool is_refused_outside = false;                   // not defined outside of the spline's times
};

struct MotionValue {
  double position = 0, speed = 0, acceleration = 0;  // rad or m, per s, per s2
};

[[nodiscard]] MotionValue evaluate(const MotionLaw& law, double time) noexcept;

// The same with the acceleration behind a jump at `time`, or, if the jump is not before `until` [s], that before it.
[[nodiscard]] MotionValue evaluate(const MotionLaw& law, double time, double until) noexcept;

// True if the law is defined at this time.
[[nodiscard]] bool holds_at(const MotionLaw& law, double time) noexcept;

// start: the coordinate in the scene's start poses, from which omitted values follow. Allocates.
[[nodiscard]] MotionLaw motion_law(const MotionDef& def, double start);

}  // namespace slew::multibody
