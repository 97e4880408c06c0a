// SPDX-License-Identifier: Apache-2.0
// The shaft that turns a pump: at a given speed, or of an engine (engine.h) through a ratio.
//
//   n = r w,   load of the engine r T,   T = alpha D p eta_m^(-s_m),   s_m = sgn(alpha p) S(n/n_w)               (1)
//   Q = alpha D n eta_v^(s_v),   s_v = S(sgn(alpha) p/p_w) S(n/n_w)                                              (2)
//   S(x) = x (15 - 10 x^2 + 3 x^4)/8 for |x| < 1, sgn x beyond: a smooth sign                                    (3)
// n speed of the pump, w of the engine, r speed_ratio, alpha swash, p pressure rise, p_w = 2 bar, n_w = 1 rad/s;
// S(n/n_w) is 1 without an engine. alpha p n > 0: the shaft drives the oil, T = alpha D p/eta_m and Q = alpha D n
// eta_v. alpha p n < 0: the oil drives the shaft, T = alpha D p eta_m and Q = alpha D n/eta_v, more oil than the
// displacement. T n - Q p >= 0 everywhere, since s_m, s_v and alpha p n have one sign: neither side gives more than it
// takes.
#pragma once

#include <cmath>
#include <string>

#include "hydraulics/circuit_builder.h"
#include "hydraulics/component.h"
#include "hydraulics/smooth.h"

namespace slew::hydraulics {

struct PumpDriveParameters {
  std::string engine;      // component; empty: the pump's own speed
  double speed_ratio = 1;  // r, speed of the pump over that of the engine
};

class PumpDrive {
 public:
  // displacement: D [m3/rad]
  PumpDrive(const PumpDriveParameters& def, double displacement, double mechanical_coefficient,
            double volumetric_coefficient, const CircuitBuilder& builder)
      : D_(displacement), efficiency_(mechanical_coefficient), log_volumetric_(std::log(volumetric_coefficient)) {
    if (def.engine.empty()) return;
    const EngineShaft& shaft = builder.shaft(def.engine);
    shaft_ = shaft.speed;
    speed_per_state_ = def.speed_ratio * shaft.reference;
    rate_per_torque_ = def.speed_ratio / (shaft.inertia * shaft.reference);
  }

  [[nodiscard]] bool has_engine() const noexcept { return shaft_ >= 0; }
  // Speed of the pump at the start [rad/s].
  [[nodiscard]] double at_start(double own) const noexcept { return has_engine() ? speed_per_state_ : own; }
  // Speed of the pump [rad/s]; own: that of a pump without an engine.
  [[nodiscard]] double speed(const CircuitView& view, double own) const noexcept {
    return has_engine() ? speed_per_state_ * view[shaft_] : own;
  }
  void declare_dependencies(StateIndex a, StateIndex b, StateIndex alpha, DependencyList& dependencies) const {
    if (!has_engine()) return;
    for (const StateIndex row : {a, b, alpha}) dependencies.add(row, shaft_), dependencies.add(shaft_, row);
    dependencies.add(shaft_, shaft_);
  }
  // alpha: swash; p: pressure rise [Pa]
  void add_load(double alpha, double p, const CircuitView& view, Rates& rates) const noexcept {
    if (has_engine()) rates.add_flow(shaft_, -rate_per_torque_ * alpha * D_ * p * factor(alpha, p, view).value);
  }
  // T [Nm]
  [[nodiscard]] double torque(double alpha, double p, const CircuitView& view) const noexcept {
    return alpha * D_ * p * factor(alpha, p, view).value;
  }
  struct Displaced {
    double value;       // flow (2) over that of a pump, alpha D n eta_v
    double over_rise;   // its slope over p [1/Pa] ...
    double over_state;  // ... and over the engine's state
  };
  [[nodiscard]] Displaced displaced(double alpha, double p, const CircuitView& view) const noexcept {
    constexpr double kWidth = 2e5;  // Pa, p_w
    if (log_volumetric_ == 0) return {1, 0, 0};
    const double side = alpha < 0 ? -1 : 1;
    const ValueSlope rise = smooth_sign(side * p / kWidth), turn = sense(view);
    const double s = rise.value * turn.value;
    if (s == 1) return {1, 0, 0};
    const double value = std::exp((s - 1) * log_volumetric_), slope = value * log_volumetric_;
    return {value, slope * rise.slope * turn.value * side / kWidth, slope * rise.value * turn.slope};
  }
  // a, b, alpha: outlet, inlet and state of the swash; per_speed: flow of a pump per speed at full swash [m3/rad]
  void stamp(StateIndex a, StateIndex b, StateIndex alpha, const CircuitView& view, double per_speed,
             JacobianStamp& jacobian) const noexcept {
    if (!has_engine()) return;
    const double p = view[a] - view[b];
    const ValueSlope f = factor(view[alpha], p, view);
    const Displaced flow = displaced(view[alpha], p, view);
    const double load = rate_per_torque_ * D_ * f.value;
    jacobian.move(b, a, shaft_,
                  per_speed * view[alpha] * speed_per_state_ * (flow.value + view[shaft_] * flow.over_state));
    jacobian.add(shaft_, alpha, -load * p);
    jacobian.add(shaft_, a, -load * view[alpha]);
    jacobian.add(shaft_, b, load * view[alpha]);
    jacobian.add(shaft_, shaft_, -rate_per_torque_ * D_ * view[alpha] * p * f.slope);
  }
  // Slope of a state's rate over the pump's speed.
  void stamp_speed(StateIndex row, double d_speed, JacobianStamp& jacobian) const noexcept {
    if (has_engine()) jacobian.add(row, shaft_, d_speed * speed_per_state_);
  }

 private:
  // (3)
  [[nodiscard]] static ValueSlope smooth_sign(double x) noexcept {
    if (std::fabs(x) >= 1) return {x < 0 ? -1.0 : 1.0, 0};
    const double y = x * x;
    return {x * (15 + y * (3 * y - 10)) / 8, 15 * (1 - y) * (1 - y) / 8};
  }
  // S(n/n_w), with its slope over the engine's state
  [[nodiscard]] ValueSlope sense(const CircuitView& view) const noexcept {
    constexpr double kTurning = 1;  // rad/s, n_w
    if (!has_engine()) return {1, 0};
    const ValueSlope s = smooth_sign(speed_per_state_ * view[shaft_] / kTurning);
    return {s.value, s.slope * speed_per_state_ / kTurning};
  }
  // eta_m^(-s_m), with its slope over the engine's state
  [[nodiscard]] ValueSlope factor(double alpha, double p, const CircuitView& view) const noexcept {
    const double side = (alpha < 0 ? p < 0 : p > 0) ? 1 : -1;
    const ValueSlope turn = sense(view);
    if (std::fabs(turn.value) == 1) return {side * turn.value > 0 ? 1 / efficiency_ : efficiency_, 0};
    const double log_efficiency = std::log(efficiency_), value = std::exp(-side * turn.value * log_efficiency);
    return {value, -side * value * log_efficiency * turn.slope};
  }

  double D_, efficiency_, log_volumetric_;
  StateIndex shaft_ = -1;
  double speed_per_state_ = 0;  // rad/s
  double rate_per_torque_ = 0;  // 1/(N m s)
};

// Speed of a diesel engine that is taken for that of any [rad/s], for the warning about pumps without relief.
inline constexpr double kTypicalEngineSpeed = 250;

// About the greatest speed of a pump [rad/s]: its own, or its share of a typical engine's.
[[nodiscard]] inline double greatest_speed(const PumpDriveParameters& drive, double own) noexcept {
  return drive.engine.empty() ? own : drive.speed_ratio * kTypicalEngineSpeed;
}

// Rules of the drive: the engine is one, and either it or a speed is stated.
void check_drive(const HydraulicsDef& circuit, const std::string& pump, const PumpDriveParameters& drive, double speed,
                 Problems& errors);

}  // namespace slew::hydraulics
