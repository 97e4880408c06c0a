// Friction and limits of a joint with one coordinate, as a force law along that coordinate.
//
//   F     = -F_c tanh(v / v_c) - d v + F_min - F_max                                               (1)
//   F_min = max(0, k (x_min - x) - c v) while x < x_min, else 0                                    (2)
//   F_max = max(0, k (x - x_max) + c v) while x > x_max, else 0                                    (3)
//
// x [rad or m] coordinate, v its speed, F [N m or N] acts along +x. F_c Coulomb friction smoothed over the speed v_c,
// d viscous friction, k and c spring and damper of the limits, which push only. Limits reach slopes of 1e4 1/s, so the
// law is evaluated inside the owner's implicit solve, never in the explicit forward dynamics.
// Source: regularised Coulomb law; end dampers as the flexible-body tutorial thesis (2017), tables 7 and 8.
// Not covered: stiction (a joint creeps at v_c atanh(F / F_c)), load-dependent friction.
#pragma once

namespace slew::multibody {

struct JointLaw {
  double coulomb = 0;            // F_c [N m or N]
  double viscous = 0;            // d [N m s/rad or N s/m]
  double friction_speed = 1e-3;  // v_c [rad/s or m/s], > 0
  double limit_min = 0;          // x_min [rad or m], -inf: none
  double limit_max = 0;          // x_max [rad or m], +inf: none
  double limit_stiffness = 0;    // k [N m/rad or N/m]
  double limit_damping = 0;      // c [N m s/rad or N s/m]
};

struct JointForce {
  double force = 0;  // F [N m or N]
  double d_x = 0;    // dF/dx
  double d_v = 0;    // dF/dv
};

[[nodiscard]] JointForce evaluate(const JointLaw& law, double x, double v) noexcept;
[[nodiscard]] inline bool touches_limit(const JointLaw& law, double x) noexcept {
  return x < law.limit_min || x > law.limit_max;
}

}  // namespace slew::multibody
