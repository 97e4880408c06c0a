#include "multibody/joint_law.h"

#include <cmath>

#include "math/stop.h"

namespace slew::multibody {

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

}  // namespace slew::multibody
