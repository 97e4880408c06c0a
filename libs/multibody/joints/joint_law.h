// SPDX-License-Identifier: Apache-2.0
// Friction and limits along one coordinate of a joint, as a force law along that coordinate; friction of a ball.
//
//   F     = -F_c tanh(v / v_c) - d v + F_min - F_max                                               (1)
//   F_min = max(0, k (x_min - x) - c v) while x < x_min, else 0                                    (2)
//   F_max = max(0, k (x - x_max) + c v) while x > x_max, else 0                                    (3)
//
// With bristles (sigma_0 > 0) the first term is -F_b of the law of contact/friction_law.h on one axis, with its exact
// update of the bending z over a sub-step h, and with the breakaway force F_s = r F_c:
//   g(v) = F_c + (F_s - F_c) exp(-(v/v_c)^2),  z' = v - sigma_0 |v| z/g,  F_b = sigma_0 z + sigma_1e z'    (4)
// They hold a joint at rest under any load below F_s.
//
// A joint that turns about a point has one friction for all directions: (1) and (4) with the speed s = |w| of the joint
// in the place of |v| and along each of three axes by its share v/s,
//   F = -F_c tanh(s / v_c) v/s - d v,  or  -F_b,  z' = v - sigma_0 s z/g(s)                        (5)
//
// x [rad or m] coordinate, v its speed, F [N m or N] acts along +x. F_c Coulomb friction smoothed over the speed v_c,
// d viscous friction, k and c spring and damper of the limits, which push only. Limits reach slopes of 1e4 1/s, so the
// law is evaluated inside the owner's implicit solve, never in the explicit forward dynamics.
// Source: regularised Coulomb law; end dampers as the flexible-body tutorial thesis (2017), tables 7 and 8.
// Not covered: stiction without bristles (a joint creeps at v_c atanh(F / F_c)), load-dependent friction; bristles
// drift under a load that swings below the breakaway force.
#pragma once

namespace slew::multibody {

struct JointLaw {
  double coulomb = 0;            // F_c [N m or N]
  double viscous = 0;            // d [N m s/rad or N s/m]
  double friction_speed = 1e-3;  // v_c [rad/s or m/s], > 0
  double bristle_stiffness = 0;  // sigma_0 [N m/rad or N/m]; 0: no bristles
  double bristle_damping = 0;    // sigma_1 [N m s/rad or N s/m]
  double breakaway_ratio = 1;    // r, >= 1
  double limit_min = 0;          // x_min [rad or m], -inf: none
  double limit_max = 0;          // x_max [rad or m], +inf: none
  double limit_stiffness = 0;    // k [N m/rad or N/m]
  double limit_damping = 0;      // c [N m s/rad or N s/m]
};

struct JointForce {
  double force = 0;  // F [N m or N]
  double d_x = 0;    // dF/dx
  double d_v = 0;    // dF/dv
  double limit = 0;  // F_min - F_max, contained in force [N m or N]
};

// (1), for a law without bristles.
[[nodiscard]] JointForce evaluate(const JointLaw& law, double x, double v) noexcept;

[[nodiscard]] inline bool has_bristles(const JointLaw& law) noexcept {
  return law.bristle_stiffness > 0;
}

// Force of either law at the end of h [s] at the speed v that began with the bending z [rad or m]; h = 0: at the
// instant.
[[nodiscard]] JointForce evaluate(const JointLaw& law, double x, double v, double h, double z) noexcept;

// One of the three parts of (5) at the part v of the speed. s is held: the law is linear in v, and stays implicit where
// it is steep. Without limits.
[[nodiscard]] JointForce evaluate_part(const JointLaw& law, double v, double s, double h, double z) noexcept;
[[nodiscard]] double bent_part(const JointLaw& law, double v, double s, double h, double z) noexcept;
[[nodiscard]] double bristle_rate_part(const JointLaw& law, double v, double s, double z) noexcept;

// Bending after h at the speed v.
[[nodiscard]] double bent(const JointLaw& law, double v, double h, double z) noexcept;

// z' of (4) [rad/s or m/s]; 0 for a law without bristles.
[[nodiscard]] double bristle_rate(const JointLaw& law, double v, double z) noexcept;

[[nodiscard]] inline bool touches_limit(const JointLaw& law, double x) noexcept {
  return x < law.limit_min || x > law.limit_max;
}

}  // namespace slew::multibody
