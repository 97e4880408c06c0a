// SPDX-License-Identifier: Apache-2.0
#include "multibody/joints/joint_law.h"

#include <algorithm>
#include <cmath>

#include "contact/friction_law.h"
#include "math/stop.h"

namespace slew::multibody {
namespace {

// viscous friction and limits
JointForce without_dry_friction(const JointLaw& law, double x, double v) noexcept {
  const math::StopForce limit =
      math::stop_force(x, v, law.limit_min, law.limit_max, law.limit_stiffness, law.limit_damping);
  return {limit.force - law.viscous * v, limit.d_x, limit.d_v - law.viscous, limit.force};
}

// the contact's law along one tangent, under a normal force of one
contact::FrictionLaw bristles_of(const JointLaw& law) noexcept {
  return {{.pressing_force = 0,
           .stiffness = law.bristle_stiffness,
           .damping = law.bristle_damping,
           .stribeck_speed = law.friction_speed,
           .viscosity = 0,
           .static_coefficient = law.coulomb * law.breakaway_ratio,
           .dynamic_coefficient = law.coulomb,
           .exponent = 2}};
}

contact::SlidingContact sliding_at(double v) noexcept {
  return {.n_W = math::Vec3(0, 0, 1), .v_W = math::Vec3(v, 0, 0), .normal_force = 1, .share = 1};
}

contact::FrictionForce bristle_force(const JointLaw& law, double v, double h, double z) noexcept {
  return contact::evaluate(bristles_of(law), sliding_at(v), h, {math::Vec3(z, 0, 0)});
}

// g of (4)
double steady_force(const JointLaw& law, double s) noexcept {
  const double over = s / law.friction_speed;
  return law.coulomb * (1 + (law.breakaway_ratio - 1) * std::exp(-over * over));
}

// (5) over h with s held: z = keep z_0 + gain v, F_b = (1 - beta) sigma_0 z + damping v
struct HeldBristles {
  double keep = 0, gain = 0, beta = 0, damping = 0;
};

HeldBristles held_bristles(const JointLaw& law, double s, double h) noexcept {
  const double g = steady_force(law, s);
  const double path = law.bristle_stiffness * s * h / g;
  HeldBristles held;
  held.keep = std::exp(-path);
  // (1 - keep) g / (sigma_0 s)
  held.gain = path > 0 ? h * -std::expm1(-path) / path : h;
  held.damping = s > 0 ? std::min(law.bristle_damping, g / s) : law.bristle_damping;
  held.beta = held.damping * s / g;
  return held;
}

}  // namespace

JointForce evaluate_part(const JointLaw& law, double v, double s, double h, double z) noexcept {
  if (!(law.coulomb > 0)) return {-law.viscous * v, 0, -law.viscous};
  if (!has_bristles(law)) {
    const double slope = s > 0 ? std::tanh(s / law.friction_speed) / s : 1 / law.friction_speed;
    const double d = law.coulomb * slope + law.viscous;
    return {-d * v, 0, -d};
  }
  const HeldBristles held = held_bristles(law, s, h);
  const double spring = (1 - held.beta) * law.bristle_stiffness;
  const double d = spring * held.gain + held.damping + law.viscous;
  return {-spring * held.keep * z - d * v, 0, -d};
}

double bent_part(const JointLaw& law, double v, double s, double h, double z) noexcept {
  if (!(law.coulomb > 0)) return 0;
  const HeldBristles held = held_bristles(law, s, h);
  return held.keep * z + held.gain * v;
}

double bristle_rate_part(const JointLaw& law, double v, double s, double z) noexcept {
  if (!has_bristles(law) || !(law.coulomb > 0)) return 0;
  return v - law.bristle_stiffness * s * z / steady_force(law, s);
}

JointForce evaluate(const JointLaw& law, double x, double v) noexcept {
  if (law.coulomb == 0) return without_dry_friction(law, x, v);
  JointForce result;
  const double t = std::tanh(v / law.friction_speed);
  result.force = -law.coulomb * t - law.viscous * v;
  result.d_v = -law.coulomb * (1 - t * t) / law.friction_speed - law.viscous;
  const math::StopForce limit =
      math::stop_force(x, v, law.limit_min, law.limit_max, law.limit_stiffness, law.limit_damping);
  result.force += limit.force;
  result.d_x = limit.d_x;
  result.d_v += limit.d_v;
  result.limit = limit.force;
  return result;
}

JointForce evaluate(const JointLaw& law, double x, double v, double h, double z) noexcept {
  if (!has_bristles(law)) return evaluate(law, x, v);
  JointForce result = without_dry_friction(law, x, v);
  // a live change may set the dry friction to 0
  if (!(law.coulomb > 0)) return result;
  const contact::FrictionForce bristles = bristle_force(law, v, h, z);
  result.force -= bristles.f_W.x();
  result.d_v -= bristles.d_velocity(0, 0);
  return result;
}

double bent(const JointLaw& law, double v, double h, double z) noexcept {
  return law.coulomb > 0 ? bristle_force(law, v, h, z).z_W.x() : 0.0;
}

double bristle_rate(const JointLaw& law, double v, double z) noexcept {
  if (!has_bristles(law) || !(law.coulomb > 0)) return 0;
  return contact::bristle_rate(bristles_of(law), sliding_at(v), math::Vec3(z, 0, 0)).x();
}

}  // namespace slew::multibody
