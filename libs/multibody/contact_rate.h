// How fast the contacts of an instant answer: what an explicit step has to resolve. Internal to the library.
//
// With slopes k, c of the laws along the directions d of all contact points (normal: spring and damping at the present
// depth; tangents: bristles), J = [d, r x d] on a link from its centre of mass and the link's own mass M = L L^T,
//   rate = max over links of  max( |C'|, sqrt |K'| ),   C' = sum of f c (L^-1 J)(L^-1 J)^T,  K' with k          (1)
// f = 1 against Ground and 2 between two links, | | a bound of the largest eigenvalue: with A the elements' absolute
// values and y their row sums
//   |C'| = max of (A y)_i / y_i  (Collatz 1942)                                                                 (2)
// The rate is an upper bound of the fastest damping rate and of the highest angular frequency of bodies that are free;
// joints only make bodies heavier, so it is one for a mechanism as well. A point mass has no rotation.
#pragma once

#include "multibody/state.h"

namespace slew::multibody {

// (1) [1/s] for the contacts of the last evaluation; 0 when nothing touches. Real-time safe.
[[nodiscard]] double contact_rate(const Model& model, Workspace& ws) noexcept;

}  // namespace slew::multibody
