// SPDX-License-Identifier: Apache-2.0
// Normal force of a contact: a spring with damping by depth, so chosen that the rebound has the wanted restitution.
//
//   F   = max(0, w k d (d/d_ref)^(n-1) (1 + chi d'))     while d > 0, else 0                        (1)
//   chi = a / v0                                                                                     (2)
//   a (1 + e) = ln[(1 + a) / (1 - a e)],   0 < a < 1/e                                               (3)
//
// d [m] depth, d' [m/s] its rate (positive: deeper); k [N/m] stiffness of the pair at the depth d_ref, n exponent
// (1 linear, 1.5 Hertz); w share of this contact point, the shares of a pair sum to 1; v0 [m/s] impact speed: the
// largest rate since the onset, at least v_min; e wanted restitution, a root of (3), the same for every k, n, mass and
// speed. (3) is the exact integral of m d'' = -F from (0, v0) to (0, -e v0).
//
// F >= 0 does not affect (3): d' = -v0/a is a trajectory of the free impact (1 + chi d' = 0 there), so that no impact
// crosses it, and e v0 < v0/a always. The maximum acts only if another force pulls the bodies apart faster.
//
// Source: Hunt and Crossley 1975 (the form of (1)); (3) replaces their chi = 3 (1 - e)/(2 v0), whose rebound is far
// from e. Deviation: v0 is kept from falling below v_min and grows when the bodies approach faster than at the onset,
// so that the damping stays finite and F <= w k d (d/d_ref)^(n-1) (1 + a) at every rate.
// Not covered: adhesion, plastic deformation, restitution that falls with speed, waves inside the bodies.
// Card: docs/models/contact_normal_law.md.
#pragma once

#include <span>
#include <string_view>

#include "core/field.h"
#include "core/problem.h"

namespace slew::contact {

struct NormalLawDef {
  double stiffness = 0;                 // k [N/m], > 0
  double restitution = 0.1;             // e [-], kSmallestRestitution .. 1
  double exponent = 1;                  // n [-], 1 .. 3; 1.5 for spheres of elastic material
  double reference_depth = 1;           // d_ref [m], > 0: depth at which the stiffness holds; no effect when n = 1
  double smallest_impact_speed = 1e-2;  // v_min [m/s], > 0: slower impacts rebound with more than e
};

// 0 would need infinite damping; 0.01 gives back 1e-4 of the energy.
inline constexpr double kSmallestRestitution = 0.01;

[[nodiscard]] std::span<const Field> normal_law_fields() noexcept;

// Appends values out of range; paths are "owner.key".
void check(std::string_view owner, const NormalLawDef& def, Problems& problems);

struct NormalLaw {
  double stiffness = 0;              // k [N/m]
  double exponent = 1;               // n
  double reference_depth = 1;        // d_ref [m]
  double smallest_impact_speed = 0;  // v_min [m/s]
  double damping_number = 0;         // a of (3)
};

// Pre-condition: check() found nothing. Solves (3) once.
[[nodiscard]] NormalLaw build(const NormalLawDef& def);

// Root of (3) for 0 < e <= 1, to 1e-14 of itself; 0 for e = 1. a < 1/e.
[[nodiscard]] double damping_number(double restitution) noexcept;

// State of one contact point.
struct NormalState {
  double impact_speed = 0;  // v0 [m/s]; 0: not touched yet
};

// Records a depth and its rate, once per accepted sub-step and before evaluate(): an open contact (d <= 0) holds the
// present speed of approach, a closed one the largest since the onset. Both are at least v_min. A contact found closed
// for the first time takes the rate found (a start in penetration: v_min, so that it leaves with v_min/a at most and
// does not shoot out).
void observe(const NormalLaw& law, double depth, double depth_rate, NormalState& state) noexcept;

// Force and slopes of (1) at one point.
struct NormalForce {
  double force = 0;         // F [N], >= 0
  double d_depth = 0;       // dF/dd [N/m], state and share held
  double d_depth_rate = 0;  // dF/dd' [N s/m], >= 0
};

// share: w of (1), 0 .. 1. Real-time safe. Pre-condition: observe() has been called for this contact.
[[nodiscard]] NormalForce evaluate(const NormalLaw& law, double share, double depth, double depth_rate,
                                   const NormalState& state) noexcept;

// The steepest slopes that a free mass [kg] meets from a depth [m] at a rate [m/s] inwards: at its deepest point, which
// is at most the depth where the spring, or the damping alone, has stopped it:
//   K (d_1^(n+1) - d^(n+1))/(n + 1) = min(m d'^2/2, m d' v0/a),   K = w k d_ref^(1-n)                 (4)
[[nodiscard]] NormalForce slopes_of_impact(const NormalLaw& law, double share, double depth, double depth_rate,
                                           const NormalState& state, double mass) noexcept;

// Energy [J] that the spring of (1) holds: integral of F over d at d' = 0.
[[nodiscard]] double stored_energy(const NormalLaw& law, double share, double depth) noexcept;

// Shares of the contact points of one pair: w_i = A_i d_i / sum of A_j d_j over the depths above 0, all 0 if there is
// none. The force does not jump when a point appears, vanishes or splits in two at the same place; points of equal
// depth and area share equally. Held over a sub-step. depths [m], areas of the points [m^2] > 0 and shares [-]: one
// entry per point.
void share_stiffness(std::span<const double> depths, std::span<const double> areas, std::span<double> shares) noexcept;

}  // namespace slew::contact
