// Joints that are cut, and gears: their forces in the recursion, and the way back onto them. Internal to the library.
//
//   u' = u'_0 + M^-1 J^T f,   J u' + b = 0   ->   W f = -(b + J u'_0),   W = J M^-1 J^T                (1)
// M and u'_0 are the tree's, so that W comes from one back-solve a row, as those of ports do (rows.h). Rows that push
// no link together have no entry in W (closing_pattern.h), so that loops beside each other cost as much as each by
// itself. (1) keeps g'' at zero only; after a step the coordinates and speeds go to the nearest ones with g = 0 and J u
// = 0 in the metric of M,
//   delta = -M^-1 J^T W^-1 g,   and the same with J u                                                   (2)
// Rows that become dependent in a singular position, or vanish there, are left out while they are (math::Semidefinite
// with the rows' mobilities elsewhere for reference). Near it (1) divides what a stage of the integrator violates by
// little, so there every stage is put back with (2) before it is evaluated.
// Source: Featherstone 2008, section 8.6, with W by back-solves; (2) as body_coordinates.h; SHAKE: Ryckaert, Ciccotti
// and Berendsen 1977.
#pragma once

#include "multibody/model/state.h"

namespace slew::multibody {

// Values of the rows of all cuts and gears, from the motion of these coordinates and speeds.
void evaluate_cuts(const Model& model, std::span<const double> q, std::span<const double> u, Workspace& ws) noexcept;

// Whether the motion and the rows' values are those of q and u already, to the bit. A projection leaves them so where
// its last look found nothing to correct: the next step's start need not make them again. Never with prescribed motion.
[[nodiscard]] bool are_shown(const Model& model, std::span<const double> q, std::span<const double> u,
                             const Workspace& ws) noexcept;

// W and its factors; needs the rows' values and factorize().
inline constexpr double kDependent = 1e-12;  // pivot, of the row's mobility
inline constexpr double kNearSingular = 1e-2;
[[nodiscard]] inline bool is_near_singular(const Workspace& ws) noexcept {
  return ws.loops.factor.smallest_pivot() < kNearSingular;
}
void factorize_cuts(const Model& model, Workspace& ws, double tolerance = kDependent) noexcept;

// Between factorize() and solve_forward(): adds to ws.residual what (1) asks for.
void close_loops(const Model& model, Workspace& ws) noexcept;

// Takes what the cuts carry out of a port's row: its residual and rate. port: of Model::rows.
void reduce_row(std::size_t port, Workspace& ws, std::span<double> residual, std::span<double> rate) noexcept;

// Motion and factors of the tree and of the cuts for these coordinates; no forces.
void renew_matrix(const Model& model, std::span<const double> q, std::span<const double> u, Workspace& ws) noexcept;

// (2), beginning with the factors that ws holds. False when the rows did not come to kClosed.
inline constexpr double kClosed = 1e-11;  // m, 1; per second; of the mechanism's size and speed where these exceed 1
[[nodiscard]] bool project(const Model& model, std::span<double> q, std::span<double> u, Workspace& ws) noexcept;

// For a step of semi-implicit Euler, u_1 = u_0 + h u', q_1 = q_0 + h u_1: adds to u_1 what closes the joints at q_1 up
// to h^3, where J u' + b = 0 alone would leave them open by -h^2 b / 2 (SHAKE),
//   M^-1 J^T W^-1 (h b / 2 - J u_0 - g_0 / h)                                                           (3)
// Then no joint does work over the step, and the speeds are those of its middle: at its end J u = h b / 2. With what
// project() would make of them the joints do work of one sign, and a mechanism left alone runs away. Rows, motion and
// factors are those of the start; not near a singular position.
void aim(const Model& model, double h, std::span<double> u, Workspace& ws) noexcept;

// Takes what such a step left open above kClosedByEuler out of q, and over h out of u, with the factors of its start.
// Near a singular position, where corrections say little about forces, as project().
inline constexpr double kClosedByEuler = 1e-9;  // m, 1; of the mechanism's size where it exceeds 1
[[nodiscard]] bool project_step(const Model& model, double h, std::span<double> q, std::span<double> u,
                                Workspace& ws) noexcept;

// Largest distance of a link from Ground's origin and largest speed, at least 1: what kClosed is multiplied by.
struct Extent {
  double length = 1, speed = 1;
};
[[nodiscard]] Extent extent_of(const Workspace& ws) noexcept;

}  // namespace slew::multibody
