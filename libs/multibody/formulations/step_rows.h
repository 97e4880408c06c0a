// SPDX-License-Identifier: Apache-2.0
// The rows of a mechanism over a whole step H: free acceleration and mobility with the springs and dampers inside.
//
// At an instant (dynamics.h) a row responds with its rigidly connected mass, M^-1. Over a step all soft elements behind
// it respond too: modes, beams between segments, bushings, spring-dampers, tyres, contacts. With the acceleration a
// constant over the step their forces at its end are those of
//   u + H a,   q (+) (H u + H^2/2 a)                                                                              (1)
// so that, with K and D their stiffness and damping and G the joints' rows,
//   [ M + H D + H^2/2 K  G^T ] [ a  ]   [ Q - H K u + J^T f ]
//   [ G                  0   ] [ mu ] = [ -b                ]                                                     (2)
//   x'' = a_free + W f                                                                                            (3)
// The implicit Euler method has H^2 in the place of H^2/2: there a mode much faster than H comes to rest within the
// step, and its oil sees half of its compliance. With H^2/2 the displacement H^2/2 a of a stiff spring is f/k.
// Comparison of the two: docs/models/coupling_levels.md.
//
// M, K, D and G in body coordinates (body_coordinates.h, integrators.h) for any formulation: K and D as in an implicit
// step, positive semi-definite. H K u omits pulls, which turn with the links.
// Not covered: laws of rows, joint friction and limits among them, which their owner condenses in addition; changes of
// G and of the velocity terms over H; stops and contacts that are reached within it.
//
// Where all springs and dampers lie in modes, between neighbours of the tree or to Ground, (2) is the recursion of
// dynamics.h with H D + H^2/2 K added to its inertias and H K u to its loads, which costs one evaluation
// (tree_matrix.h). Else one factorisation in body coordinates and one solution a row, as an evaluation of `lagrange`.
// Only the constructor allocates.
#pragma once

#include <span>
#include <vector>

#include "multibody/formulations/body_coordinates.h"
#include "multibody/formulations/tree_matrix.h"

namespace slew::multibody {

// Shares of (2): position of H^2 K, rate of H D, strain of H K u. Those of (1), or those of the trapezoidal rule's
// response to a held force: (M + H/2 D + H^2/4 K) a = Q - H/2 K u + J^T F, exact for linear elements.
struct StepShares {
  double position = 0.5, rate = 1, strain = 1;
};
inline constexpr StepShares kTrapezoidalShares{0.25, 0.5, 0.5};

class StepRows {
 public:
  // Allocates. evaluate() takes any model of the same mechanism.
  explicit StepRows(const Model& model);

  // (2) over H [s], for the rows that are active in `at`. False: singular to working precision.
  [[nodiscard]] bool evaluate(const Model& model, const State& state, const Workspace& at, double H,
                              StepShares shares = {}) noexcept;

  // After evaluate(), laid out as row_free_accelerations() and row_mobility() of dynamics.h.
  [[nodiscard]] std::span<const double> free_accelerations() const noexcept { return ws_.row_a_free; }
  [[nodiscard]] std::span<const double> mobility() const noexcept { return ws_.row_W; }

 private:
  [[nodiscard]] bool evaluate_tree(const Model& model, const State& state, double H, StepShares shares) noexcept;
  [[nodiscard]] bool evaluate_bodies(const Model& model, const State& state, double H, StepShares shares) noexcept;
  void subtract_strain(const Model& model, double H) noexcept;

  TreeMatrix tree_;
  BodyModel body_;
  Workspace ws_;
  BodyWorkspace bws_;
  std::vector<double> strain_;  // H K u by first_row()
};

// True if any element of the mechanism has K or D.
[[nodiscard]] bool has_springs(const Model& model) noexcept;

}  // namespace slew::multibody
