#include "multibody/joint_law.h"

#include <cmath>

namespace slew::multibody {

JointForce evaluate(const JointLaw& law, double x, double v) noexcept {
  JointForce result;
  const double t = std::tanh(v / law.friction_speed);
  result.force = -law.coulomb * t - law.viscous * v;
  result.d_v = -law.coulomb * (1 - t * t) / law.friction_speed - law.viscous;
  // depth and its rate are counted into the stop; only a positive sum pushes
  if (x < law.limit_min) {
    const double push = law.limit_stiffness * (law.limit_min - x) - law.limit_damping * v;
    if (push > 0) {
      result.force += push;
      result.d_x -= law.limit_stiffness;
      result.d_v -= law.limit_damping;
    }
  } else if (x > law.limit_max) {
    const double push = law.limit_stiffness * (x - law.limit_max) + law.limit_damping * v;
    if (push > 0) {
      result.force -= push;
      result.d_x -= law.limit_stiffness;
      result.d_v -= law.limit_damping;
    }
  }
  return result;
}

}  // namespace slew::multibody
