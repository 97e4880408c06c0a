// SPDX-License-Identifier: Apache-2.0
// The passes of one evaluation, in the order in which dynamics.cpp calls them. Internal to the library.
#pragma once

#include <span>

#include "multibody/model/state.h"

namespace slew::multibody {

// Poses, velocities and the accelerations with u' = 0 of all links, from Ground outwards.
void update_motion(const Model& model, std::span<const double> q, std::span<const double> u, Workspace& ws) noexcept;

// Length, angle and their rates of the force elements: those that a step needs, or all for their variables.
enum class Elements { used, all };
void update_elements(const Model& model, std::span<const double> q, Elements which, Workspace& ws) noexcept;

// Relative angular speed about a rotational element's axis, a . w_rel: what its damper acts on [rad/s].
[[nodiscard]] double damper_speed(const AngleElement& element, const Workspace& ws) noexcept;

// Torque of a rotational element's own law on its second link; needs its motion.
[[nodiscard]] math::Vec3 torque_of(const AngleElement& element, const AngleMotion& motion,
                                   const Workspace& ws) noexcept;

// Inertia of every link about its origin in Ground axes and its bias wrench, and the coupled masses.
void update_inertia(const Model& model, Workspace& ws) noexcept;
void update_coupled(const Model& model, Workspace& ws) noexcept;

// All loads except rows at the motion in ws, with inertias and coupled masses: elements and contacts found at these
// joint coordinates and subtracted from the bias wrenches.
void apply_all(const Model& model, std::span<const double> q, Workspace& ws) noexcept;

// Subtracts spring-dampers, then the rows' forces ws.row_force, from the bias wrenches.
void apply_elements(const Model& model, Workspace& ws) noexcept;
void apply_row_forces(const Model& model, Workspace& ws) noexcept;

// Motion, inertias, all loads except rows, and the closing rows' values: all that the two passes below need.
void find_loads(const Model& model, std::span<const double> q, std::span<const double> u, Workspace& ws) noexcept;
// Both passes, with the closing rows: ws.udot.
void solve_accelerations(const Model& model, Workspace& ws) noexcept;

// Backward pass: articulated inertias, factors and residuals; forward pass: udot from residuals.
void factorize(const Model& model, Workspace& ws) noexcept;
void solve_forward(const Model& model, Workspace& ws, std::span<const double> residual,
                   std::span<double> udot) noexcept;

// Moves the coordinates by the small displacement of the last solve_forward() in the space of the speeds; the links'
// turns are taken from ws.delta_alpha. Quaternions stay normalised.
void displace(const Model& model, const Workspace& ws, std::span<const double> step, std::span<double> q) noexcept;

// Backward pass of generalised forces tau alone (no bias, no velocities) with the factors of factorize(), over the
// links of `supports` (outermost first), outside of which tau is zero. Gives the residual r and the rate D^-1 r: the
// product of two right-hand sides through M^-1 is the sum of one's residual times the other's rate. Entries of other
// links are not changed.
void solve_backward(const Model& model, Workspace& ws, std::span<const int> supports, std::span<const double> tau,
                    std::span<double> residual, std::span<double> rate) noexcept;

// The same for up to kMaxJointRows rows between two links, whose unit forces are their gradients: residual and rate are
// rows x speeds.
void solve_backward(const Model& model, Workspace& ws, std::span<const int> supports, int link1, int link2,
                    std::span<const RowValue> rows, std::span<double> residual, std::span<double> rate) noexcept;

// Coordinates a displacement away from others, base + scale times the speeds u, and the motion there. Turns of
// quaternions are exponentials in Ground axes, of turn + scale times the link's angular velocity, by link.
struct Displacement {
  double scale = 0;                  // s
  std::span<const double> base;      // by u [rad or m]
  std::span<const math::Vec3> turn;  // rad
};
void move_from(const Model& model, std::span<const double> start, const Displacement& displacement,
               std::span<const double> u, std::span<double> q, Workspace& ws) noexcept;

// Normalises quaternions of any length.
void normalize_quaternions(const Model& model, std::span<double> q) noexcept;

// q' of the coordinates for speeds u; needs the motion of the same q and u.
void coordinate_rates(const Model& model, const Workspace& ws, std::span<const double> q, std::span<const double> u,
                      std::span<double> qdot) noexcept;

}  // namespace slew::multibody
