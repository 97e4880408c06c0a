// Contact within a sub-step. Internal to the library.
//
// Impact speeds and bristles (contact/contact_memory.h) are state: they change when a sub-step is accepted. An
// evaluation t after the start of the sub-step sees them carried along from there:
//   z(t) = exact solution of the bristles' law with the mean sliding velocity since the start,      (1)
//          the way of the material points that touch now, over t
//   v0   = the largest of the remembered one, the speed of approach now and, for a contact that was open at the
//          start, the speed of approach there                                                          (2)
// so that an impact without other forces has its exact v0, and sticking follows the way of the integrator to the bit.
#pragma once

#include "multibody/model/state.h"

namespace slew::multibody {

// At the start of a sub-step, before the first update: the evaluations to come belong to this state.
void begin_contacts(const Model& model, const State& state, Workspace& ws) noexcept;

// Before an evaluation that belongs to `later` [s] after the start.
inline void set_stage_time(const Model& model, const State& start, double later, Workspace& ws) noexcept {
  set_time(model, start.time + later, ws);
  if (ws.contact != nullptr) ws.contact->time = later;
}

// Contacts and their forces at the motion in ws, ws.contact->time after the start.
void update_contacts(const Model& model, Workspace& ws) noexcept;

// Subtracts the forces from the bias wrenches.
void apply_contacts(const Model& model, Workspace& ws) noexcept;

// After a sub-step of h [s], with the motion of the new state in ws: the memory of the state becomes that of the end.
// Shapes that went through each other unseen set ws.contact->is_lost, a blow ws.contact->is_hit.
void accept_contacts(const Model& model, double h, State& state, Workspace& ws) noexcept;

// How a sub-step treats contacts: by a rule that has to resolve them, by such a rule with an implicit one at hand for
// what rests or is pressed (formulation.h), by corrections without their slopes (`augmented`), or with their slopes
// inside the iteration.
enum class StepKind { explicit_rule, settling, corrected, implicit };

// At most so many parts of a sub-step for contacts that answer fast.
inline constexpr double kMostStiffParts = 1024;
// Longest part times fastest rate: Runge-Kutta's rule is stable to 2.7, with a stack of ten boxes on bristles to 2.1;
// in the trapezoid of `augmented` corrections shrink by a half at 1.
[[nodiscard]] constexpr double reach_of(StepKind kind) noexcept {
  return kind == StepKind::corrected ? 1.0 : 1.5;
}

// An implicit part costs as much as 1.2 to 3.3 of Runge-Kutta's, least where finding the contacts costs most.
inline constexpr double kWorthSettling = 2;

struct ContactParts {
  int count = 1;
  bool is_settling = false;  // by the implicit rule; what it leaves to the other one
  int pieces = 1;            // is resolved in at least so many pieces of each part
};

// In how many equal parts a sub-step of h [s] from here should go, after an evaluation at its start: one when nothing
// touches and the present speeds lead into nothing within h; there is then no search until the next start. Contacts
// that touch are resolved as fast as they answer (contact_rate.h); those too fast for the shortest part set
// ws.contact->is_lost. `settling`: where nothing hits anything and that would take kWorthSettling times as many parts
// as contact_substep, the implicit rule takes over, which need not resolve how fast a load is damped.
[[nodiscard]] ContactParts contact_parts(const Model& model, double h, StepKind kind, Workspace& ws) noexcept;

// The same for one of `parts` of the sub-step, of what has come to touch on the way.
[[nodiscard]] ContactParts contact_parts_again(const Model& model, double h, int parts, StepKind kind,
                                               Workspace& ws) noexcept;

// What the force of one contact point loses by a small motion of shape A against shape B, after update_contacts() at an
// instant after the start: position and rate of the weights, ways beginning at the start.
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
