// SPDX-License-Identifier: Apache-2.0
// Spring, damper and end dampers of a force element along its coordinate x (length or angle). Internal to the library.
//
//   F = -k (x - x_0) - d v - s(x - x_0) - b(v) + max(0, k_e (x_min - x) - d_e v) - max(0, k_e (x - x_max) + d_e v) (1)
// the last two while x is outside its range: an end damper pushes back and never pulls. s and b are tables, which stand
// in the place of k and d.
#pragma once

#include "math/stop.h"
#include "multibody/model/model.h"

namespace slew::multibody {

// The second term and b [N or N m].
[[nodiscard]] inline double damper_force(const ElementLaw& law, double speed) noexcept {
  return -law.damping * speed - (law.damper_curve.empty() ? 0.0 : math::value_at(law.damper_curve, speed));
}

// damper_speed replaces v in the second term: a rotational damper acts about the axis, its spring along the gradient.
[[nodiscard]] inline double force_of(const ElementLaw& law, double x, double v, double damper_speed) noexcept {
  double force = -law.spring * (x - law.free) + damper_force(law, damper_speed);
  if (!law.spring_curve.empty()) force -= math::value_at(law.spring_curve, x - law.free);
  if (law.end_spring > 0) force += math::stop_force(x, v, law.min, law.max, law.end_spring, law.end_damping).force;
  return force;
}

// Whether (1) depends on x: a damper alone needs no coordinate.
[[nodiscard]] inline bool has_spring(const ElementLaw& law) noexcept {
  return law.spring != 0 || law.end_spring != 0 || !law.spring_curve.empty();
}

// -dF/dx, -dF/dv of the end dampers, and that of the damper alone.
struct ElementSlopes {
  double stiffness = 0, end_damping = 0, damping = 0;
};
[[nodiscard]] inline ElementSlopes slopes_of(const ElementLaw& law, double x, double v, double damper_speed) noexcept {
  ElementSlopes slopes{law.spring, 0, law.damping};
  if (!law.spring_curve.empty()) slopes.stiffness += math::slope_at(law.spring_curve, x - law.free);
  if (!law.damper_curve.empty()) slopes.damping += math::slope_at(law.damper_curve, damper_speed);
  if (law.end_spring > 0) {
    const math::StopForce stop = math::stop_force(x, v, law.min, law.max, law.end_spring, law.end_damping);
    slopes.stiffness -= stop.d_x;
    slopes.end_damping -= stop.d_v;
  }
  return slopes;
}

[[nodiscard]] inline double stored_energy(const ElementLaw& law, double x) noexcept {
  double energy = 0.5 * law.spring * (x - law.free) * (x - law.free);
  if (!law.spring_curve.empty()) energy += math::integral_to(law.spring_curve, x - law.free);
  if (law.end_spring > 0) {
    const double depth = x < law.min ? law.min - x : x > law.max ? x - law.max : 0;
    energy += 0.5 * law.end_spring * depth * depth;
  }
  return energy;
}

}  // namespace slew::multibody
