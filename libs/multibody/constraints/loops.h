// SPDX-License-Identifier: Apache-2.0
// Cut joints and gears: their forces in the recursion, and the projection onto them. Internal to the library.
//
//   u' = u'_0 + M^-1 J^T f,   J u' + b = 0   ->   W f = -(b + J u'_0),   W = J M^-1 J^T                (1)
// M and u'_0 are the tree's, so that W comes from one back-solve a row, as those of ports do (rows.h). Rows without a
// common link have no entry in W (closing_pattern.h), so that separate loops cost as much as each by itself. (1) keeps
// g'' at zero only; after a step the coordinates and speeds go to the nearest ones with g = 0 and J u = 0 in the metric
// of M,
//   delta = -M^-1 J^T W^-1 g,   and the same with J u                                                   (2)
// Rows that become dependent in a singular position, or vanish there, are left out while they are (math::Semidefinite
// with the rows' mobilities elsewhere for reference). Near it (1) divides the violation of a stage by a small number,
// so there every stage is projected with (2) before it is evaluated.
// Source: Featherstone 2008, section 8.6, with W by back-solves; (2) as body_coordinates.h; SHAKE: Ryckaert, Ciccotti
// and Berendsen 1977.
#pragma once

#include "multibody/model/state.h"

namespace slew::multibody {

// Values of the rows of all cuts and gears, from the motion of these coordinates and speeds.
void evaluate_cuts(const Model& model, std::span<const double> q, std::span<const double> u, Workspace& ws) noexcept;

// True if the motion and the rows' values already belong to q and u, to the bit: after a projection whose last check
// found no violation. The next step's start then need not recompute them. Never with prescribed motion.
[[nodiscard]] bool are_shown(const Model& model, std::span<const double> q, std::span<const double> u,
                             const Workspace& ws) noexcept;

// Motion and rows' values of these coordinates and speeds, which the next step's start need not recompute either.
void show(const Model& model, std::span<const double> q, std::span<const double> u, Workspace& ws) noexcept;

// W and its factors; needs the rows' values and factorize().
inline constexpr double kDependent = 1e-12;  // pivot, share of the row's mobility
inline constexpr double kNearSingular = 1e-2;
[[nodiscard]] inline bool is_near_singular(const Workspace& ws) noexcept {
  return ws.loops.factor.smallest_pivot() < kNearSingular;
}
void factorize_cuts(const Model& model, Workspace& ws, double tolerance = kDependent) noexcept;

// Call between factorize() and solve_forward(): adds the closing forces of (1) to ws.residual.
void close_loops(const Model& model, Workspace& ws) noexcept;

// Removes the part carried by the cuts from a port's row: its residual and rate. port: index in Model::rows.
void reduce_row(std::size_t port, Workspace& ws, std::span<double> residual, std::span<double> rate) noexcept;

// Motion and factors of the tree and of the cuts for these coordinates; no forces.
void renew_matrix(const Model& model, std::span<const double> q, std::span<const double> u, Workspace& ws) noexcept;

// (2), beginning with the factors in ws. False if the rows did not reach kClosed.
inline constexpr double kClosed = 1e-11;  // m, 1; per second; of the mechanism's size and speed where these exceed 1
[[nodiscard]] bool project(const Model& model, std::span<double> q, std::span<double> u, Workspace& ws) noexcept;

// For a step of semi-implicit Euler, u_1 = u_0 + h u', q_1 = q_0 + h u_1: adds the speeds that close the joints at q_1
// up to h^3, where J u' + b = 0 alone would leave them open by -h^2 b / 2 (SHAKE),
//   M^-1 J^T W^-1 (h b / 2 - J u_0 - g_0 / h)                                                           (3)
// Then no joint does work over the step, and the speeds are those of its middle: at its end J u = h b / 2. With the
// speeds of project() the joints would do work of one sign, and a free mechanism would gain energy without limit. Rows,
// motion and factors are those of the start; not near a singular position.
void aim(const Model& model, double h, std::span<double> u, Workspace& ws) noexcept;

// Removes violations of such a step above kClosedByEuler from q, and over h from u, with the factors of its start. Near
// a singular position, where corrections give little information on forces, as project().
inline constexpr double kClosedByEuler = 1e-9;  // m, 1; of the mechanism's size where it exceeds 1
[[nodiscard]] bool project_step(const Model& model, double h, std::span<double> q, std::span<double> u,
                                Workspace& ws) noexcept;

// Largest distance of a link from Ground's origin and largest speed, at least 1: what kClosed is multiplied by.
struct Extent {
  double length = 1, speed = 1;
};
[[nodiscard]] Extent extent_of(const Workspace& ws) noexcept;

}  // namespace slew::multibody
