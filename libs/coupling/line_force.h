// SPDX-License-Identifier: Apache-2.0
// The force that an actuator's line transmits: pressure force less friction plus end stops. One code for mechanics,
// hydraulics and the monolith, so that all three use the same cylinder.
//
//   F_line = F - F_mu + F_stop + F_c                                                               (1)
//   F_mu   = (|F| (1 - eta) f(|v|) + (F_seal + F_brk exp(-(v/v_s)^2)) min(|v| / v_seal, 1)) sgn(v) + c_v v   (2)
//   F_stop = max(0, k d_min - c v) - max(0, k d_max + c v)                                         (3)
//            d_min = x_min - x while x < x_min, else the first term is 0; d_max = x - x_max likewise
//   F_c    = f(x - x_min, -v) - f(x_max - x, v), the brake f of each end's cushion (math/cushion.h)   (4)
//
// F [N] pressure force, positive pushes the stroke open; x [m], v [m/s] stroke and its speed; eta efficiency
// ("cylinder coefficient"); f friction curve over speed, piecewise linear, last value held. A stop never pulls.
// Source: flexible-body tutorial thesis (2017), table 2 (cylinder; modulus and sign added: the printed form would
// create energy), tables 16 to 18. Not covered: temperature, dwell-time dependence of the breakaway force.
#pragma once

#include <cmath>
#include <vector>

#include "core/field.h"
#include "math/cushion.h"
#include "math/stop.h"

namespace slew::coupling {

struct LineForceDef {
  Table friction_curve;           // speed [m/s >= 0], coefficient [-], from [0, 0] on; empty: no curve
  double efficiency = 1;          // eta, 0 < eta <= 1
  double seal_friction = 0;       // F_seal [N], >= 0
  double seal_speed = 1e-4;       // v_seal [m/s], > 0: speed at which the seal friction is fully there
  double viscous_friction = 0;    // c_v [N s/m], >= 0
  double stroke_min = 0;          // [m]
  double stroke_max = 0;          // [m]
  double stop_stiffness = 0;      // k [N/m], >= 0
  double stop_damping = 0;        // c [N s/m], >= 0
  double breakaway_friction = 0;  // F_brk [N], >= 0: of the seals near rest, whatever the pressure
  double stribeck_speed = 0.01;   // v_s [m/s], > 0
  math::CushionDef cushion_min = {}, cushion_max = {};
};

// A force law's value and slopes at one point.
struct LineForce {
  double force = 0;       // F_line [N]
  double d_pressure = 1;  // dF_line/dF [-]
  double d_position = 0;  // dF_line/dx [N/m]
  double d_speed = 0;     // dF_line/dv [N s/m]
  double stop = 0;        // F_stop, contained in force [N]
};

class LineForceLaw {
 public:
  explicit LineForceLaw(const LineForceDef& def);

  [[nodiscard]] LineForce evaluate(double F, double x, double v) const noexcept;
  [[nodiscard]] double friction(double F, double v) const noexcept;    // F_mu of (2) [N]
  [[nodiscard]] double stop_force(double x, double v) const noexcept;  // F_stop of (3) [N]
  [[nodiscard]] bool has_cushion() const noexcept { return has_cushion_; }
  [[nodiscard]] double cushion_force(double x, double v) const noexcept;  // F_c of (4) [N]
  // Time [s] until a falling speed v with the acceleration a and its rate j [m/s3] is just before the edge of the steep
  // part of the friction about rest; for a speed at the edge, until just behind it. Infinite if the speed does not
  // reach the edge or there is no steep part.
  [[nodiscard]] double time_to_rest(double v, double a, double j) const noexcept;
  [[nodiscard]] double friction_scale(double F) const noexcept;  // |F| (1 - eta) [N]
  [[nodiscard]] bool touches_stop(double x) const noexcept { return x < def_.stroke_min || x > def_.stroke_max; }
  [[nodiscard]] const LineForceDef& def() const noexcept { return def_; }

 private:
  struct Coefficient {
    double value, slope;
  };
  struct Friction {
    double force, d_pressure, d_speed;
  };
  // Segment of the friction curve, from `start` to that of the next one.
  struct Segment {
    double start, value, slope;  // m/s, 1, s/m
  };
  [[nodiscard]] Coefficient curve_at(double speed) const noexcept;
  [[nodiscard]] Friction friction_at(double F, double v) const noexcept;
  [[nodiscard]] Coefficient breakaway_at(double speed) const noexcept;  // N, N s/m
  [[nodiscard]] math::StopForce stop_at(double x, double v) const noexcept;
  void add_cushions(double x, double v, LineForce& line) const noexcept;

  LineForceDef def_;
  math::Cushion cushion_min_, cushion_max_;
  bool has_cushion_;
  std::vector<Segment> segments_;  // the last one holds its value
  double loss_;                    // 1 - eta
  double seal_slope_;              // F_seal / v_seal [N s/m]
  double curve_edge_ = 0;          // speeds below which the curve and the seal go to zero [m/s]; 0: none
  double seal_edge_ = 0;
  bool has_friction_;
};

// Evaluated in the machine's stiffest iteration, several ten times a millisecond: all of it inline.

inline LineForceLaw::Coefficient LineForceLaw::curve_at(double speed) const noexcept {
  if (segments_.empty()) return {0, 0};
  // a speed stays in its segment for many calls: the same few comparisons each time
  const Segment* segment = segments_.data();
  const Segment* const last = segment + segments_.size() - 1;
  if (speed >= last->start) return {last->value, 0};
  while (segment != last && speed >= segment[1].start) ++segment;
  if (speed < segment->start) return {segment->value, 0};
  return {segment->value + segment->slope * (speed - segment->start), segment->slope};
}

inline double LineForceLaw::friction_scale(double F) const noexcept {
  return std::fabs(F) * loss_;
}

// (2) and its slopes
inline LineForceLaw::Friction LineForceLaw::friction_at(double F, double v) const noexcept {
  if (!has_friction_) return {0, 0, 0};
  const double speed = std::fabs(v);
  const double direction = v > 0 ? 1.0 : (v < 0 ? -1.0 : 0.0);
  const Coefficient f = curve_at(speed);
  const bool seal_slips = speed >= def_.seal_speed;
  const double scale = friction_scale(F);
  const double magnitude = scale * f.value + (seal_slips ? def_.seal_friction : seal_slope_ * speed);
  Friction friction{.force = direction * magnitude + def_.viscous_friction * v,
                    .d_pressure = direction * std::copysign(loss_, F) * f.value,
                    .d_speed = scale * f.slope + (seal_slips ? 0.0 : seal_slope_) + def_.viscous_friction};
  if (def_.breakaway_friction > 0) {
    const Coefficient breakaway = breakaway_at(speed);
    friction.force += direction * breakaway.value;
    friction.d_speed += breakaway.slope;
  }
  return friction;
}

// (3) and its slopes
inline math::StopForce LineForceLaw::stop_at(double x, double v) const noexcept {
  return math::stop_force(x, v, def_.stroke_min, def_.stroke_max, def_.stop_stiffness, def_.stop_damping);
}

inline LineForce LineForceLaw::evaluate(double F, double x, double v) const noexcept {
  const Friction friction = friction_at(F, v);
  const math::StopForce stop = stop_at(x, v);
  LineForce line{.force = F - friction.force + stop.force,
                 .d_pressure = 1 - friction.d_pressure,
                 .d_position = stop.d_x,
                 .d_speed = stop.d_v - friction.d_speed,
                 .stop = stop.force};
  if (has_cushion_) add_cushions(x, v, line);
  return line;
}

}  // namespace slew::coupling
