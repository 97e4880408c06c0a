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

double LineForceLaw::friction_scale(double F) const noexcept { return std::fabs(F) * (1 - def_.efficiency); }

double LineForceLaw::friction(double F, double v) const noexcept {
  const double speed = std::fabs(v);
  const double magnitude =
      friction_scale(F) * curve_at(speed).value + def_.seal_friction * std::min(speed / def_.seal_speed, 1.0);
  return std::copysign(magnitude, v);
}

double LineForceLaw::stop_force(double x, double v) const noexcept {
  double force = 0;
  if (x < def_.stroke_min) {
    force += std::max(0.0, def_.stop_stiffness * (def_.stroke_min - x) - def_.stop_damping * v);
  }
  if (x > def_.stroke_max) {
    force -= std::max(0.0, def_.stop_stiffness * (x - def_.stroke_max) + def_.stop_damping * v);
  }
  return force;
}

LineForce LineForceLaw::evaluate(double F, double x, double v) const noexcept {
  LineForce line;
  // friction (2) and its slopes
  const double speed = std::fabs(v);
  const double direction = v > 0 ? 1.0 : (v < 0 ? -1.0 : 0.0);
  const Coefficient f = curve_at(speed);
  const bool seal_slips = speed >= def_.seal_speed;
  const double scale = friction_scale(F);
  const double magnitude = scale * f.value + def_.seal_friction * (seal_slips ? 1.0 : speed / def_.seal_speed);
  line.force = F - direction * magnitude;
  line.d_pressure = 1 - direction * std::copysign(1 - def_.efficiency, F) * f.value;
  line.d_speed = -scale * f.slope - (seal_slips ? 0.0 : def_.seal_friction / def_.seal_speed);
  // end stops (3): slopes only while the stop pushes
  const double stop = stop_force(x, v);
  line.force += stop;
  if (stop != 0) {
    line.d_position = -def_.stop_stiffness;
    line.d_speed -= def_.stop_damping;
  }
  return line;
}

}  // namespace slew::coupling
