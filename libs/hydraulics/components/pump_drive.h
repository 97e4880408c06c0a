// SPDX-License-Identifier: Apache-2.0
// The shaft that turns a pump: at a given speed, or of an engine (engine.h) through a ratio.
//
//   n = r w,   load of the engine r T,   T = alpha D p / eta_m (alpha p > 0),  alpha D p eta_m (alpha p < 0)       (1)
//   Q = alpha D n eta_v^s,   s = x (15 - 10 x^2 + 3 x^4)/8,   x = clip(alpha p/(|alpha| p_w), -1, 1)             (2)
// n speed of the pump, w of the engine, r speed_ratio, alpha swash, p pressure rise, p_w = 2 bar. (2) is alpha D n
// eta_v for a pump and alpha D n / eta_v for one that its oil drives, which takes more oil than its displacement;
// smooth between them, and without a loss at p = 0. With (1) the oil and the shaft never give more than they take.
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
  void add_load(double alpha, double p, Rates& rates) const noexcept {
    if (has_engine()) rates.add_flow(shaft_, -rate_per_torque_ * alpha * D_ * p * factor(alpha, p));
  }
  // T [Nm]
  [[nodiscard]] double torque(double alpha, double p) const noexcept { return alpha * D_ * p * factor(alpha, p); }
  // Flow (2) over that of a pump, alpha D n eta_v; slope over the pressure rise p.
  [[nodiscard]] ValueSlope displaced(double alpha, double p) const noexcept {
    constexpr double kWidth = 2e5;  // Pa, p_w
    const double x = (alpha < 0 ? -p : p) / kWidth;
    if (x >= 1 || log_volumetric_ == 0) return {1, 0};
    if (x <= -1) return {std::exp(-2 * log_volumetric_), 0};
    const double y = x * x, s = x * (15 + y * (3 * y - 10)) / 8, d_s = 15 * (1 - y) * (1 - y) / 8;
    const double value = std::exp((s - 1) * log_volumetric_);
    return {value, value * log_volumetric_ * d_s / (alpha < 0 ? -kWidth : kWidth)};
  }
  // a, b, alpha: outlet, inlet and state of the swash, full_slope: flow per speed at full swash [m3/rad]
  void stamp(StateIndex a, StateIndex b, StateIndex alpha, const CircuitView& view, double full_slope,
             JacobianStamp& jacobian) const noexcept {
    if (!has_engine()) return;
    const double p = view[a] - view[b], load = rate_per_torque_ * D_ * factor(view[alpha], p);
    jacobian.move(b, a, shaft_, full_slope * view[alpha] * speed_per_state_);
    jacobian.add(shaft_, alpha, -load * p);
    jacobian.add(shaft_, a, -load * view[alpha]);
    jacobian.add(shaft_, b, load * view[alpha]);
  }
  // Slope of a state's rate over the pump's speed.
  void stamp_speed(StateIndex row, double d_speed, JacobianStamp& jacobian) const noexcept {
    if (has_engine()) jacobian.add(row, shaft_, d_speed * speed_per_state_);
  }

 private:
  // a pump that is driven by its oil loses on the other side
  [[nodiscard]] double factor(double alpha, double p) const noexcept {
    return (alpha < 0 ? p < 0 : p > 0) ? 1 / efficiency_ : efficiency_;
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
