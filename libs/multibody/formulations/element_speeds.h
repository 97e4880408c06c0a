// SPDX-License-Identifier: Apache-2.0
// Whether an explicit integrator follows what force elements do to the masses they act on.
//
// The equations about the start, at rest and linear in displacement x and speed v of the joint coordinates,
//   x' = v,   v' = A_x x + A_v v                                                                                (1)
// A as differences of forward dynamics, so that masses, joints and modes are those of the mechanism, and the
// integrator's own map of one sub-step h,
//   rk4                  z_1 = sum_{k=0..4} (h A)^k / k! z_0,   z = (x, v)
//   semi_implicit_euler  v_1 = v_0 + h a(x_0, v_0),  x_1 = x_0 + h v_1                                          (2)
// A rate lambda of (1), or of (z_1 - z_0)/h of (2), is too fast where the map grows by more than 1.001 in a sub-step
// and more than exp(h lambda). The rates are the eigenvalues of the operator on the space of
//   z, A z, A^2 z, ...                                                                                          (3)
// of 60 vectors at most (Arnoldi: Golub and Van Loan 2013, section 10.5): all of a small mechanism, the fastest of a
// large one.
//
// One-sided forces (end dampers, ropes, tyres) under semi_implicit_euler, which takes touches whole: alone, in four
// times the sub-step.
//
// Laws have their steepest slopes (steepest_laws.h): tables, end dampers, taut ropes, tyres on the ground with their
// slip. A law with a bound, such as a table for friction, does not grow for ever, but a sub-step beyond the limit
// leaves it at the bound, at rest as well. Left out: contacts, which find their own parts of a sub-step; gravity; rows,
// whose owner solves them implicitly; the modes and segments alone (build/validate_flexible.h). An instant, not a
// bound for all poses.
#pragma once

#include <optional>
#include <string>

#include "core/problem.h"
#include "multibody/formulations/integrators.h"
#include "multibody/model/model.h"
#include "multibody/model/parameters.h"

namespace slew::multibody {

[[nodiscard]] constexpr bool is_explicit(Integrator rule) noexcept {
  return rule == Integrator::rk4 || rule == Integrator::semi_implicit_euler;
}

// Whether a parameter of this kind is a mass or a law that the check sees.
[[nodiscard]] bool may_speed_up(ParameterKind kind) noexcept;

struct TooFast {
  std::string element{};    // that grows most when it is alone
  double growth = 0;        // factor in one sub-step
  double rate = 0;          // |lambda| of its fastest motion [1/s]
  double longest_step = 0;  // s, that does not let it grow
  bool swings = false;      // that motion is an oscillation
  bool is_at_end = false;   // by its end dampers
  bool is_touch = false;    // a touch that semi_implicit_euler does not resolve, otherwise stable
};

// In sub-steps of h [s]. None: the rule is implicit or follows.
[[nodiscard]] std::optional<TooFast> find_too_fast_element(const Model& model, Integrator rule, double h);

// The sentence for it: what, and what would be right.
[[nodiscard]] Problem problem_of(const TooFast& found, Integrator rule, double h);

// The same for a scene's mechanics, as a problem. Pre-condition: validate() found nothing.
void check_element_speeds(const MechanicsDef& mechanics, double h, Problems& problems);

}  // namespace slew::multibody
