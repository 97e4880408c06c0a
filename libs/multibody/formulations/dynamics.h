// SPDX-License-Identifier: Apache-2.0
// Forward dynamics of the tree, its reduced model at the rows, and the integrator.
//
// A row is a scalar coordinate x of the mechanism with speed v = J u, through which a force f acts (positive f pushes
// x to grow). At one instant
//   x'' = a_free + W f,   u' = u'_free + M^-1 J^T f,   W = J M^-1 J^T,   a_free = J u'_free + J' u   (1)
// where u'_free is caused by gravity, spring-dampers and inertia with all row forces at zero. Actuators, and joints
// with friction or limits (joint_law.h), act through rows only, so that their stiff laws can be solved implicitly with
// (1) by the owner; the sub-step then takes each row's force as linear in time.
//
// A sub-step from the owner's side:
//   evaluate(model, state, ws);                       // rows at the start: x, v, a_free, W
//   ... solve for the rows' mean force and slope over h ...
//   advance(model, state, ws, h, mean, slope);        // fourth-order Runge-Kutta, quaternions normalised once
// Joints that are cut (loops.h) are part of u'_free, M^-1 and W above, and closed after every sub-step.
//
// Cost: O(links), one backward and one forward pass an evaluation, one back-solve a row. Nothing here allocates,
// locks or throws. Source: Featherstone 2008, chapter 7; W as M^-1 = (I - U..)^T D^-1 (I - U..) of Rodriguez 1991.
#pragma once

#include <span>

#include "multibody/model/state.h"

namespace slew::multibody {

// Motion, elements, free accelerations (ws.udot_free) and all active rows at the state's instant.
void evaluate(const Model& model, const State& state, Workspace& ws) noexcept;

// Only u' with the given row forces (one per row; empty: none), at any coordinates and speeds.
void forward_dynamics(const Model& model, std::span<const double> q, std::span<const double> u,
                      std::span<const double> row_forces, Workspace& ws) noexcept;

// Rows after evaluate(): [m or rad], [m/s or rad/s], [m/s2 or rad/s2]; W row-major, rows x rows [1/kg or 1/(kg m2)],
// symmetric to the bit. Rows and columns of an inactive row are zero, and so is its a_free.
[[nodiscard]] inline std::span<const double> row_positions(const Workspace& ws) noexcept {
  return ws.row_x;
}
[[nodiscard]] inline std::span<const double> row_speeds(const Workspace& ws) noexcept {
  return ws.row_v;
}
[[nodiscard]] inline std::span<const double> row_free_accelerations(const Workspace& ws) noexcept {
  return ws.row_a_free;
}
[[nodiscard]] inline std::span<const double> row_mobility(const Workspace& ws) noexcept {
  return ws.row_W;
}
[[nodiscard]] inline std::span<const double> row_jacobian(const Workspace& ws) noexcept {
  return ws.row_J;
}

// An inactive row carries no force and costs nothing but its x and v.
void activate_row(Workspace& ws, int row) noexcept;
void deactivate_row(Workspace& ws, int row) noexcept;

// After evaluate(): u' for the given row forces, and the column M^-1 J^T of one row.
void accelerations(const Model& model, Workspace& ws, std::span<const double> row_forces,
                   std::span<double> udot) noexcept;
void response_column(const Model& model, Workspace& ws, int row, std::span<double> column) noexcept;

// One Runge-Kutta sub-step of h [s]; force of a row: mean + (t - h/2) slope, 0 <= t <= h. Pre-condition: evaluate() was
// called for this state since it last changed. False: the loops could not be closed.
bool advance(const Model& model, State& state, Workspace& ws, double h, std::span<const double> mean,
             std::span<const double> slope) noexcept;

// The same without row forces; needs no evaluate().
bool advance_free(const Model& model, State& state, Workspace& ws, double h) noexcept;

// Number of equal sub-steps for a step of the given length [s].
[[nodiscard]] int substep_count(const Model& model, double step) noexcept;

[[nodiscard]] bool is_finite(const State& state) noexcept;

}  // namespace slew::multibody
