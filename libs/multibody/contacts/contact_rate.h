// SPDX-License-Identifier: Apache-2.0
// Rate of the contacts at an instant, which an explicit step must resolve. Internal to the library.
//
// With slopes k, c of the laws along the directions d of all contact points (normal: spring and damping at the present
// depth; tangents: bristles), J = [d, r x d] on a link from its centre of mass and the link's own mass M = L L^T,
//   rate = max over links of  max( |C'|, sqrt |K'| ),   C' = sum of f c (L^-1 J)(L^-1 J)^T,  K' with k          (1)
// f = 1 against Ground and 2 between two links, | | a bound of the largest eigenvalue: with A the elements' absolute
// values and y their row sums
//   |C'| = max of (A y)_i / y_i  (Collatz 1942)                                                                 (2)
// The rate is an upper bound of the fastest damping rate and of the highest angular frequency of bodies that are free;
// joints only make bodies heavier, so it is one for a mechanism as well. A point mass has no rotation.
//
// A deepening contact becomes faster: the normal slopes are those at the deepest point that a free mass reaches from
// here (contact/normal_law.h, (4)); for a ball from outside the damping then gives sqrt(2 k a/m).
#pragma once

#include "contact/sweep.h"
#include "multibody/model/state.h"

namespace slew::multibody {

// springs: only sqrt |K'|, of pairs with a restitution of kPlastic or more. An implicit rule need not resolve damping
// for the right rebound, and below kPlastic a touch that ends at rest is as good.
enum class RateOf { all, springs };
inline constexpr double kPlastic = 0.05;
[[nodiscard]] bool rebounds(const contact::NormalLaw& law) noexcept;

// (1) [1/s] for the contacts of the last evaluation; 0 when nothing touches. Real-time safe.
[[nodiscard]] double contact_rate(const Model& model, Workspace& ws, RateOf chosen = RateOf::all) noexcept;

// The same [1/s] for a pair that does not touch yet and meets within the next h [s]; pair: index of the tested pairs.
[[nodiscard]] double impact_rate(const Model& model, const Workspace& ws, std::size_t pair,
                                 const contact::Meeting& meeting, double h, RateOf chosen = RateOf::all) noexcept;

// Speed [m/s] at which the shapes approach each other at a meeting, with the motion of now.
[[nodiscard]] double approach_speed(const Model& model, const Workspace& ws, std::size_t pair,
                                    const contact::Meeting& meeting) noexcept;

// True if a contact point (of a pair that `chosen` takes) closes or opens faster than the smallest impact speed of its
// law.
[[nodiscard]] bool has_impact(const Model& model, const Workspace& ws, RateOf chosen = RateOf::all) noexcept;

// True if no contact point closes or opens that fast now, or after h [s] with the accelerations of the last
// solve_forward(). A shape at the deepest point of an impact is slow as well, but its spring drives it away.
[[nodiscard]] bool stays_slow(const Model& model, double h, const Workspace& ws) noexcept;

}  // namespace slew::multibody
