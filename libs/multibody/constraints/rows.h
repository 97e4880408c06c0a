// SPDX-License-Identifier: Apache-2.0
// Rows: Jacobian, coordinate, speed, free acceleration and mobility at one instant. Internal to the library.
#pragma once

#include <span>

#include "multibody/model/state.h"

namespace slew::multibody {

// Needs motion, elements and factors of the same state, and ws.udot_free.
void evaluate_rows(const Model& model, const State& state, Workspace& ws) noexcept;

// M^-1 J^T forces (one per row) by the present factors, closing rows included, into udot.
void respond(const Model& model, std::span<const double> forces, Workspace& ws, std::span<double> udot) noexcept;

// x'' of an active row under u', from the motion of this q and u with u' = 0; J: its gradient, overwritten, zero
// outside of the row's path.
[[nodiscard]] double row_acceleration(const Model& model, const Workspace& ws, std::size_t row,
                                      std::span<const double> udot, std::span<double> J) noexcept;

// Friction and limits of a joint's row at these coordinates and speeds of all rows, at the end of h [s] that began with
// the bending z; h = 0: at the instant. Pre-condition: the row is a joint's.
[[nodiscard]] JointForce joint_force(const Model& model, std::size_t row, std::span<const double> x,
                                     std::span<const double> v, double h, double z) noexcept;
[[nodiscard]] double joint_bristle_rate(const Model& model, std::size_t row, std::span<const double> v,
                                        double z) noexcept;

// The law of a joint's row (a ball has it in the first of its rows), and the size of its angular velocity.
[[nodiscard]] const JointLaw& law_of(const Model& model, std::size_t row) noexcept;
[[nodiscard]] double ball_speed(const Model& model, std::size_t row, std::span<const double> v) noexcept;

// Relative angular velocity of a ball about the row's axis: rate, its bias and gradient; g is 0.
[[nodiscard]] RowValue turn_of_ball(const Model& model, const Row& row, const Workspace& ws) noexcept;

// Coordinate of a joint that is cut, for its row of friction and limits.
[[nodiscard]] RowValue coordinate_of_cut(const Model& model, const Row& row, const Workspace& ws) noexcept;

// x'' of a row's coordinate with u' = 0, from the motion with u' = 0 [m/s2, rad/s2].
[[nodiscard]] double bias_of_length(const LineElement& element, const LineMotion& line, const Workspace& ws) noexcept;
[[nodiscard]] double bias_of_angle(const AngleElement& element, const AngleMotion& angle, const Workspace& ws) noexcept;

}  // namespace slew::multibody
