// A wire rope over points on bodies: one tension all along it, over frictionless pulleys without radius.
//
//   L = sum |P_k+1 - P_k|,   s = L - L_0,   T = T_s + min(T_s, max(-T_s, T_d)) while s > 0, else 0    (1)
//   T_s = k s or the table at s,   T_d = d L' or the table at L',   k = EA/L_0 where EA is given
// The damper carries at most what the spring does: the tension begins and ends at zero without a jump, never pushes,
// and the damper only takes energy. On point k acts T (e_k,k+1 + e_k,k-1), e the unit vectors towards its neighbours.
//
// Not covered: mass, bending and sag of the rope, friction and inertia of pulleys; the speed at which L_0 is changed
// does not enter the damper. Card: docs/models/multibody_rope.md.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "math/monotone_cubic.h"
#include "multibody/forces/limited_damper.h"
#include "multibody/forces/wrench.h"

namespace slew::multibody {

struct RopePoint {
  int link = 0, body = 0;
  math::Vec3 p_L;  // m, in the link
};

struct Rope {
  std::string name;
  std::vector<RopePoint> points;  // from one end to the other, two or more
  double free_length = 0;         // L_0 [m], > 0
  double spring = 0;              // k [N/m], of the whole rope; 0: by rigidity or table
  double rigidity = 0;            // EA [N]
  double damping = 0;             // d [N s/m]
  math::MonotoneCubic spring_curve, damper_curve;
};

struct RopeState {
  double length = 0;   // L [m]
  double rate = 0;     // L' [m/s]
  double slack = 0;    // max(0, L_0 - L) [m]
  double tension = 0;  // T [N]
  int springs = 0;     // LimitedForce
};

// motion: of all links.
[[nodiscard]] RopeState state_of(const Rope& rope, std::span<const LinkMotion> motion) noexcept;
[[nodiscard]] double stored_energy(const Rope& rope, const RopeState& state) noexcept;  // J

// Slopes of the tension over L and L', where they rise.
struct RopeSlopes {
  double stiffness = 0;  // N/m
  double damping = 0;    // N s/m
};
[[nodiscard]] RopeSlopes slopes_of(const Rope& rope, const RopeState& state) noexcept;

// Points and the unit vector from point k to point k + 1, Ground; zero where both are in one place.
[[nodiscard]] math::Vec3 position_of(const Rope& rope, std::size_t k, std::span<const LinkMotion> motion) noexcept;
[[nodiscard]] math::Vec3 direction(math::Vec3 from, math::Vec3 to) noexcept;

// On the link of point k, by the tension of state_of().
[[nodiscard]] Wrench wrench_on(const Rope& rope, std::size_t k, double tension,
                               std::span<const LinkMotion> motion) noexcept;

}  // namespace slew::multibody
