// SPDX-License-Identifier: Apache-2.0
#include "coupling/line_force.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace slew::coupling {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
// Margin of a speed before the edge: the error that the extrapolation may have without passing the edge.
constexpr double kMargin = 0.02;
// share of the edge's speed: surely behind the edge, and near enough that the steep part changes the speed little
constexpr double kInside = 0.97;

}  // namespace

LineForceLaw::LineForceLaw(const LineForceDef& def)
    : def_(def),
      cushion_min_(def.cushion_min),
      cushion_max_(def.cushion_max),
      has_cushion_(cushion_min_.exists() || cushion_max_.exists()),
      loss_(1 - def.efficiency),
      seal_slope_(def.seal_friction / def.seal_speed),
      has_friction_((!def.friction_curve.empty() && def.efficiency != 1) || def.seal_friction > 0 ||
                    def.viscous_friction > 0 || def.breakaway_friction > 0) {
  const Table& curve = def_.friction_curve;
  for (std::size_t i = 0; i < curve.size(); ++i) {
    const bool is_last = i + 1 == curve.size();
    const double slope = is_last ? 0 : (curve[i + 1][1] - curve[i][1]) / (curve[i + 1][0] - curve[i][0]);
    segments_.push_back({curve[i][0], curve[i][1], slope});
  }
  if (curve.size() > 1 && curve[0][0] == 0 && curve[0][1] == 0 && loss_ > 0) curve_edge_ = curve[1][0];
  if (def_.seal_friction > 0 || def_.breakaway_friction > 0) seal_edge_ = def_.seal_speed;
}

double LineForceLaw::time_to_rest(double v, double a, double j) const noexcept {
  if (!(v * a < 0)) return kNever;
  const double speed = std::fabs(v);
  double edge = 0;
  for (const double next : {curve_edge_, seal_edge_}) {
    if (speed > next) edge = std::max(edge, next);
  }
  if (edge == 0) return kNever;
  const double margin = kMargin * speed;
  const double change = speed - edge > 2 * margin ? speed - edge - margin : speed - kInside * edge;
  // b t - c t^2/2 = change of speed, the earlier time
  const double b = std::fabs(a), c = a > 0 ? -j : j;
  const double root = b * b - 2 * c * change;
  return root >= 0 ? 2 * change / (b + std::sqrt(root)) : kNever;
}

// (2): F_brk exp(-(v/v_s)^2) min(|v|/v_seal, 1)
LineForceLaw::Coefficient LineForceLaw::breakaway_at(double speed) const noexcept {
  const double ratio = speed / def_.stribeck_speed, left = def_.breakaway_friction * std::exp(-ratio * ratio);
  const double share = std::fmin(speed / def_.seal_speed, 1.0),
               growth = speed < def_.seal_speed ? 1 / def_.seal_speed : 0;
  return {left * share, left * (growth - 2 * share * ratio / def_.stribeck_speed)};
}

double LineForceLaw::friction(double F, double v) const noexcept {
  return friction_at(F, v).force;
}

// (4) and its slopes
void LineForceLaw::add_cushions(double x, double v, LineForce& line) const noexcept {
  if (cushion_min_.exists()) {
    const math::CushionBrake brake = cushion_min_.at(x - def_.stroke_min, -v);
    line.force += brake.force;
    line.d_position += brake.d_remaining;
    line.d_speed -= brake.d_closing;
  }
  if (cushion_max_.exists()) {
    const math::CushionBrake brake = cushion_max_.at(def_.stroke_max - x, v);
    line.force -= brake.force;
    line.d_position += brake.d_remaining;
    line.d_speed -= brake.d_closing;
  }
}

double LineForceLaw::cushion_force(double x, double v) const noexcept {
  LineForce line{.force = 0};
  if (has_cushion_) add_cushions(x, v, line);
  return line.force;
}

double LineForceLaw::stop_force(double x, double v) const noexcept {
  return stop_at(x, v).force;
}

}  // namespace slew::coupling
