// SPDX-License-Identifier: Apache-2.0
// Friction of a contact: bristles that bend, hold and slip (LuGre), isotropic in the tangential plane.
//
//   g(s) = N (mu_d + (mu_s - mu_d) exp(-(s/v_s)^p)),   s = |v|,   N = F_n + F_0                       (1)
//   z'   = v - sigma_0 s z / g(s)                                                                     (2)
//   F    = sigma_0 z + sigma_1e z' + sigma_2 v,   sigma_1e = min(sigma_1, g(s)/s)                     (3)
//
// v [m/s] sliding velocity of A against B in the tangential plane, z [m] bending of the bristles, F [N] force on B
// along v (A gets -F): friction opposes v. F_n normal force, F_0 constant pressing force. Vectors are tangential and in
// world axes; no direction of the plane is marked, so the law is the same in every frame.
//
// Over a sub-step h, with v and N held, (2) has the exact solution
//   z+ = E z + (1 - E) (g / sigma_0) v/s,   E = exp(-sigma_0 s h / g)                                 (4)
// a weighted mean of z and the steady bending: it cannot blow up at any h. At v = 0 nothing moves: true stiction.
//
// With beta = sigma_1e s / g <= 1 the bristle force is (1 - beta) sigma_0 z + beta g v/s: a weighted mean too, so that
// |F - sigma_2 v| <= mu_s N always, and F.v >= d/dt(sigma_0 z^2/2) at every speed.
//
// Source: Canudas de Wit, Olsson, Astrom and Lischinsky 1995, eq. 1 to 5. Deviations: (1) depends on the normal force
// and z is cut to mu_s N/sigma_0 when N falls; sigma_1 is limited in (3), since with a constant one the force leaves
// the cone and feeds energy above s = 4 g/sigma_1. Not covered: drift under a load that swings below the breakaway
// force (known of this model), dwell time, torque of friction about the normal of a single point.
// Card: docs/models/contact_friction.md.
#pragma once

#include <span>
#include <string_view>

#include "core/field.h"
#include "core/problem.h"
#include "math/vector3.h"

namespace slew::contact {

// Table 12 of the thesis, in its order and with its values.
struct FrictionLawDef {
  double pressing_force = 0;         // F_0 [N], >= 0
  double stiffness = 4000;           // sigma_0 [N/m], > 0
  double damping = 500;              // sigma_1 [N s/m], >= 0
  double stribeck_speed = 0.01;      // v_s [m/s], > 0
  double viscosity = 0.1;            // sigma_2 [N s/m], >= 0
  double static_coefficient = 0.3;   // mu_s [-], >= mu_d
  double dynamic_coefficient = 0.1;  // mu_d [-], > 0
  double exponent = 2;               // p [-], 1 .. 4
};

[[nodiscard]] std::span<const Field> friction_law_fields() noexcept;

// Appends values out of range; paths are "owner.key".
void check(std::string_view owner, const FrictionLawDef& def, Problems& problems);

// A checked FrictionLawDef.
struct FrictionLaw {
  FrictionLawDef def;
};

// Pre-condition: check() found nothing.
[[nodiscard]] FrictionLaw build(const FrictionLawDef& def);

// State of one contact point.
struct FrictionState {
  math::Vec3 z_W;  // z [m], world axes, in the tangential plane
};

// A contact point at one instant.
struct SlidingContact {
  math::Vec3 n_W;           // unit normal, world axes
  math::Vec3 v_W;           // v [m/s]; its component along the normal is ignored
  double normal_force = 0;  // F_n [N], >= 0; with 0 there is no contact and no friction
  double share = 1;         // share of this point in the pair's sigma_0, sigma_1, sigma_2 and F_0
};

struct FrictionForce {
  math::Vec3 f_W;         // F [N], world axes
  math::Mat3 d_velocity;  // dF/dv [N s/m], symmetric only in parts; zero along the normal
  math::Vec3 d_normal;    // dF/dF_n [-]
  math::Vec3 z_W;         // bending at the end of the sub-step [m]
};

// Force at the end of a sub-step of length h [s] that began with `state` and has the velocity and normal force of
// `contact`; h = 0 gives (3) directly. Derivatives are those of the force at the end with h held, through (4).
// At v = 0 exactly, where |v| has a kink, the derivative is the mean of both sides. Real-time safe.
[[nodiscard]] FrictionForce evaluate(const FrictionLaw& law, const SlidingContact& contact, double h,
                                     const FrictionState& state) noexcept;

// z' of (2) [m/s], for integrators that carry z themselves; contact.normal_force + F_0 > 0.
[[nodiscard]] math::Vec3 bristle_rate(const FrictionLaw& law, const SlidingContact& contact, math::Vec3 z_W) noexcept;

// sigma_0 z^2 / 2 of this point [J].
[[nodiscard]] double stored_energy(const FrictionLaw& law, double share, const FrictionState& state) noexcept;

// Turns z with the normal from `from` to `to` (shortest rotation) and then by `spin` [rad] about it; keeps its length.
// Opposite normals: a different contact, z becomes 0.
void turn_bristle(math::Vec3 from, math::Vec3 to, double spin, FrictionState& state) noexcept;

}  // namespace slew::contact
