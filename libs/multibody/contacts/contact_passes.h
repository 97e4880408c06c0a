// SPDX-License-Identifier: Apache-2.0
// Contact within a sub-step. Internal to the library.
//
// Impact speeds and bristles (contact/contact_memory.h) are state: they change when a sub-step is accepted. An
// evaluation t after the start of the sub-step uses values advanced from there:
//   z(t) = exact solution of the bristles' law with the mean sliding velocity since the start,      (1)
//          the displacement of the presently touching material points, over t
//   v0   = the largest of the remembered one, the speed of approach now and, for a contact that was open at the
//          start, the speed of approach there                                                          (2)
// so that an impact without other forces has its exact v0, and sticking follows the integrator's displacement to the
// bit.
#pragma once

#include "multibody/model/state.h"

namespace slew::multibody {

// Call at the start of a sub-step, before the first update: later evaluations belong to this state.
void begin_contacts(const Model& model, const State& state, Workspace& ws) noexcept;

// Call before an evaluation at `later` [s] after the start.
inline void set_stage_time(const Model& model, const State& start, double later, Workspace& ws) noexcept {
  set_time(model, start.time + later, ws);
  if (ws.contact != nullptr) ws.contact->time = later;
}

// Contacts and their forces at the motion in ws, ws.contact->time after the start.
void update_contacts(const Model& model, Workspace& ws) noexcept;

// Subtracts the forces from the bias wrenches.
void apply_contacts(const Model& model, Workspace& ws) noexcept;

// Call after a sub-step of h [s], with the motion of the new state in ws: the memory of the state becomes that of the
// end. Shapes that passed through each other set ws.contact->is_lost, an impact sets ws.contact->is_hit.
void accept_contacts(const Model& model, double h, State& state, Workspace& ws) noexcept;

// Treatment of contacts in a sub-step: by a rule that must resolve them, by such a rule together with an implicit one
// for resting or pressed contacts (formulation.h), by corrections without their slopes (`augmented`), or with their
// slopes inside the iteration.
enum class StepKind { explicit_rule, settling, corrected, implicit };

// Limit of parts of a sub-step for fast contacts.
inline constexpr double kMostStiffParts = 1024;
// Longest part times fastest rate: Runge-Kutta's rule is stable to 2.7, with a stack of ten boxes on bristles to 2.1;
// in the trapezoid of `augmented` corrections shrink by a half at 1; the semi-implicit Euler rule is stable with a
// spring and a damper of 1, but at 1.5 throws back with up to 1.2 times the speed of the impact.
inline constexpr double kReach = 1.5, kReachOfCorrections = 1.0, kReachOfEuler = 0.1, kReachOfEulerAtRest = 1.0;

struct ContactStep {
  StepKind kind = StepKind::explicit_rule;
  double reach = kReach;          // of impacts
  double reach_at_rest = kReach;  // of present contacts where nothing lands
};

// Implicit rules are stable in any part. For the rebound, under them and under `augmented`, parts of a blow are that
// short against its spring; beyond the second value, the third under `augmented`, a rebound is wrong by more than 0.05
// of the impact speed, and flagged.
inline constexpr double kReachOfBlow = 0.2, kLostBlow = 0.35, kLostBlowOfCorrections = 0.7;

// An implicit part costs as much as 1.2 to 3.3 of Runge-Kutta's, least where finding the contacts costs most.
inline constexpr double kWorthSettling = 2;

struct ContactParts {
  int count = 1;
  bool is_settling = false;  // true: by the implicit rule
  int pieces = 1;            // least number of pieces of each part for the other rule
};

// Number of equal parts for a sub-step of h [s], after an evaluation at its start: one if no shapes touch and none meet
// within h at the present speeds; there is then no search until the next start. What meets is resolved at the rate of
// its impact: two shapes, or another corner of two that touch, faster than the smallest impact speed of their law.
// Touching contacts are resolved at their rate (contact_rate.h); contacts too fast for the shortest part set
// ws.contact->is_lost. `settling`: without an impact, and if the explicit rule would need kWorthSettling times as many
// parts as contact_substep, the implicit rule is used, which need not resolve the damping of a load. `implicit`: the
// contacts of impacts that rebound alone. `corrected`: those of impacts that rebound finer.
[[nodiscard]] ContactParts contact_parts(const Model& model, double h, ContactStep step, Workspace& ws) noexcept;

// The same for one of `parts` of the sub-step, for contacts closed meanwhile and corners of touching pairs that land in
// it.
[[nodiscard]] ContactParts contact_parts_again(const Model& model, double h, int parts, ContactStep step,
                                               Workspace& ws) noexcept;

// Loss of one contact point's force by a small motion of shape A against shape B, after update_contacts() at an instant
// after the start: position and rate of the weights, displacements from the start.
struct ContactSlopes {
  int link_a = 0, link_b = 0;
  math::Vec3 n_W;         // unit
  double along = 0;       // along n, with the share of the point held
  double of_share = 0;    // along n, on top of it: the share grows with the depth
  math::Mat3 tangential;  // across n; not symmetric
};
[[nodiscard]] ContactSlopes slopes_of_contact(const Model& model, const Workspace& ws, std::size_t index,
                                              ChangeWeights weights) noexcept;

}  // namespace slew::multibody
