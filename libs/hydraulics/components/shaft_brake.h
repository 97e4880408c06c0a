// SPDX-License-Identifier: Apache-2.0
// Holding brake on a shaft: applied by springs, released by pressure, with true stiction.
//
//   s  = brake_share clip(1 - (p_x - p_c) / brake_release_pressure, 0, 1)    share of brake_torque that the discs hold
//   (1) b' = -g(s) v / brake_twist - sgn(b) ramp(|b| - s, w) / tau (2) T  = b brake_torque torque on the shaft (3)
// p_x pressure at the brake's port, p_c in the room of its springs (the case drain, without one the atmosphere), v
// speed of the shaft [rad/s], brake_twist the angle that builds up the whole torque.
//
// Below s the brake is a spring without a leak: a shaft under a load below s brake_torque comes to rest and stays where
// it is, also under a load that swings. Beyond s the discs slip: b follows s with the time tau = kSlip brake_twist, at
// the speed v above it by kSlip v. g = min(1, s / kGrip) ends the spring where the discs part. For a constant s the
// brake only dissipates: -T v = d/dt (brake_torque brake_twist b^2 / (2 g)) + a loss >= 0.
//
// This is the perfectly elastic, viscoplastic law of one dimension (Simo and Hughes 1998, Computational Inelasticity,
// section 1.7.1) with the friction of the discs as the yield limit. Not covered: volume and travel of the brake's
// piston (give its port a volume and an orifice: they set the time of release and application), heat and fading
// (brake_share is live), difference of static and sliding friction, drag of the open discs.
#pragma once

#include <cmath>

#include "hydraulics/smooth.h"

namespace slew::hydraulics {

struct ShaftBrakeParameters {
  double torque = 0;               // Nm, without pressure
  double release_pressure = 20e5;  // Pa above the springs' room at which the discs part
  double twist = 0.0175;           // rad at the shaft from no torque to the whole
  double share = 1;                // of the torque that is left: 1 as new, 0 without a brake
};

// Rate of b of (2) with its slopes, and g / brake_twist.
struct BrakeRate {
  double value, over_b, over_speed, over_pressure;
};

namespace shaft_brake {

inline constexpr double kSlip = 2e-4;      // s/rad; small, so that the sliding torque hardly depends on the speed
inline constexpr double kGrip = 0.05;      // share of the torque below which the discs part
inline constexpr double kCorner = 0.01;    // smoothing of the discs' force at its ends
inline constexpr double kOnset = 1e-3;     // w, smoothing of the onset of slip
inline constexpr double kGripWidth = 0.1;  // smoothing of g

// (1) at the difference p_x - p_c, with its slope
[[nodiscard]] inline ValueSlope held_share(const ShaftBrakeParameters& brake, double p) noexcept {
  const ValueSlope clip = unit_clip(1 - p / brake.release_pressure, kCorner);
  return {brake.share * clip.value, -brake.share * clip.slope / brake.release_pressure};
}

[[nodiscard]] inline ValueSlope grip(double s) noexcept {
  const ValueSlope g = unit_clip(s / kGrip, kGripWidth);
  return {g.value, g.slope / kGrip};
}

// (2) at the difference p_x - p_c
[[nodiscard]] inline BrakeRate rate(const ShaftBrakeParameters& brake, double b, double v, double p) noexcept {
  const ValueSlope s = held_share(brake, p), g = grip(s.value);
  const double turn = v / brake.twist, per_tau = 1 / (kSlip * brake.twist), sign = std::copysign(1.0, b);
  const ValueSlope over = ramp(std::fabs(b) - s.value, kOnset);
  return {.value = -g.value * turn - sign * over.value * per_tau,
          .over_b = -over.slope * per_tau,
          .over_speed = -g.value / brake.twist,
          .over_pressure = s.slope * (sign * over.slope * per_tau - g.slope * turn)};
}

}  // namespace shaft_brake
}  // namespace slew::hydraulics
