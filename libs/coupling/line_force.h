// The force that an actuator's line transmits: pressure force less friction plus end stops. One code for mechanics,
// hydraulics and the monolith, so that all three feel the same cylinder.
//
//   F_line = F - F_mu + F_stop                                                                     (1)
//   F_mu   = (|F| (1 - eta) f(|v|) + F_seal min(|v| / v_seal, 1)) sgn(v) + c_v v                   (2)
//   F_stop = max(0, k d_min - c v) - max(0, k d_max + c v)                                         (3)
//            d_min = x_min - x while x < x_min, else the first term is 0; d_max = x - x_max likewise
//
// F [N] pressure force, positive pushes the stroke open; x [m], v [m/s] stroke and its speed; eta efficiency
// ("cylinder coefficient"); f friction curve over speed, piecewise linear, last value held. A stop never pulls.
// Source: flexible-body tutorial thesis (2017), table 2 (cylinder; modulus and sign added: the printed form would
// create energy), tables 16 to 18. Not covered: temperature, dwell-time dependence of the breakaway force.
#pragma once

#include <span>
#include <vector>

#include "core/field.h"
#include "math/stop.h"

namespace slew::coupling {

struct LineForceDef {
  Table friction_curve;         // speed [m/s >= 0], coefficient [-], from [0, 0] on; empty: no curve
  double efficiency = 1;        // eta, 0 < eta <= 1
  double seal_friction = 0;     // F_seal [N], >= 0
  double seal_speed = 1e-4;     // v_seal [m/s], > 0: speed at which the seal friction is fully there
  double viscous_friction = 0;  // c_v [N s/m], >= 0
  double stroke_min = 0;        // [m]
  double stroke_max = 0;        // [m]
  double stop_stiffness = 0;    // k [N/m], >= 0
  double stop_damping = 0;      // c [N s/m], >= 0
};

// A force law's value and slopes at one point.
struct LineForce {
  double force = 0;       // F_line [N]
  double d_pressure = 1;  // dF_line/dF [-]
  double d_position = 0;  // dF_line/dx [N/m]
  double d_speed = 0;     // dF_line/dv [N s/m]
};

class LineForceLaw {
 public:
  explicit LineForceLaw(const LineForceDef& def);

  [[nodiscard]] LineForce evaluate(double F, double x, double v) const noexcept;
  [[nodiscard]] double friction(double F, double v) const noexcept;    // F_mu of (2) [N]
  [[nodiscard]] double stop_force(double x, double v) const noexcept;  // F_stop of (3) [N]
  [[nodiscard]] double friction_scale(double F) const noexcept;        // |F| (1 - eta) [N]
  [[nodiscard]] bool touches_stop(double x) const noexcept { return x < def_.stroke_min || x > def_.stroke_max; }
  [[nodiscard]] const LineForceDef& def() const noexcept { return def_; }

 private:
  struct Coefficient {
    double value, slope;
  };
  struct Friction {
    double force, d_pressure, d_speed;
  };
  [[nodiscard]] Coefficient curve_at(double speed) const noexcept;
  [[nodiscard]] Friction friction_at(double F, double v) const noexcept;
  [[nodiscard]] math::StopForce stop_at(double x, double v) const noexcept;

  LineForceDef def_;
  std::vector<double> segment_slope_;  // of the curve, by segment
};

}  // namespace slew::coupling
