#include "multibody/joint_law.h"

#include <cmath>

#include "contact/friction_law.h"
#include "math/stop.h"

namespace slew::multibody {
namespace {

// viscous friction and limits
JointForce without_dry_friction(const JointLaw& law, double x, double v) noexcept {
  const math::StopForce limit =
      math::stop_force(x, v, law.limit_min, law.limit_max, law.limit_stiffness, law.limit_damping);
  return {limit.force - law.viscous * v, limit.d_x, limit.d_v - law.viscous};
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

}  // namespace

JointForce evaluate(const JointLaw& law, double x, double v) noexcept {
  JointForce result;
  const double t = std::tanh(v / law.friction_speed);
  result.force = -law.coulomb * t - law.viscous * v;
  result.d_v = -law.coulomb * (1 - t * t) / law.friction_speed - law.viscous;
  const math::StopForce limit =
      math::stop_force(x, v, law.limit_min, law.limit_max, law.limit_stiffness, law.limit_damping);
  result.force += limit.force;
  result.d_x = limit.d_x;
  result.d_v += limit.d_v;
  return result;
}

JointForce evaluate(const JointLaw& law, double x, double v, double h, double z) noexcept {
  if (!has_bristles(law)) return evaluate(law, x, v);
  JointForce result = without_dry_friction(law, x, v);
  // a live change may take the dry friction away
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
