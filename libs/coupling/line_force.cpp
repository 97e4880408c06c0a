#include "coupling/line_force.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace slew::coupling {

LineForceLaw::LineForceLaw(const LineForceDef& def) : def_(def) {
  const Table& curve = def_.friction_curve;
  for (std::size_t i = 0; i + 1 < curve.size(); ++i) {
    segment_slope_.push_back((curve[i + 1][1] - curve[i][1]) / (curve[i + 1][0] - curve[i][0]));
  }
}

LineForceLaw::Coefficient LineForceLaw::curve_at(double speed) const noexcept {
  const Table& curve = def_.friction_curve;
  if (curve.empty()) return {0, 0};
  if (speed >= curve.back()[0]) return {curve.back()[1], 0};
  if (speed < curve.front()[0]) return {curve.front()[1], 0};
  // the segment that starts at or before the speed; the last point's case is above
  const auto after = std::upper_bound(curve.begin(), curve.end(), speed,
                                      [](double v, const std::array<double, 2>& point) { return v < point[0]; });
  const auto i = static_cast<std::size_t>(after - curve.begin()) - 1;
  return {curve[i][1] + segment_slope_[i] * (speed - curve[i][0]), segment_slope_[i]};
}

double LineForceLaw::friction_scale(double F) const noexcept {
  return std::fabs(F) * (1 - def_.efficiency);
}

// (2) and its slopes
LineForceLaw::Friction LineForceLaw::friction_at(double F, double v) const noexcept {
  const double speed = std::fabs(v);
  const double direction = v > 0 ? 1.0 : (v < 0 ? -1.0 : 0.0);
  const Coefficient f = curve_at(speed);
  const bool seal_slips = speed >= def_.seal_speed;
  const double scale = friction_scale(F);
  const double magnitude = scale * f.value + def_.seal_friction * (seal_slips ? 1.0 : speed / def_.seal_speed);
  return {
      .force = direction * magnitude + def_.viscous_friction * v,
      .d_pressure = direction * std::copysign(1 - def_.efficiency, F) * f.value,
      .d_speed = scale * f.slope + (seal_slips ? 0.0 : def_.seal_friction / def_.seal_speed) + def_.viscous_friction};
}

// (3) and its slopes
math::StopForce LineForceLaw::stop_at(double x, double v) const noexcept {
  return math::stop_force(x, v, def_.stroke_min, def_.stroke_max, def_.stop_stiffness, def_.stop_damping);
}

double LineForceLaw::friction(double F, double v) const noexcept {
  return friction_at(F, v).force;
}

double LineForceLaw::stop_force(double x, double v) const noexcept {
  return stop_at(x, v).force;
}

LineForce LineForceLaw::evaluate(double F, double x, double v) const noexcept {
  const Friction friction = friction_at(F, v);
  const math::StopForce stop = stop_at(x, v);
  return {.force = F - friction.force + stop.force,
          .d_pressure = 1 - friction.d_pressure,
          .d_position = stop.d_x,
          .d_speed = stop.d_v - friction.d_speed};
}

}  // namespace slew::coupling
