// SPDX-License-Identifier: Apache-2.0
// The passes of the penalty formulations. Internal to the library.
#pragma once

#include <span>

#include "multibody/formulations/body_passes.h"
#include "multibody/formulations/body_penalty.h"

namespace slew::multibody {

// Motion, elements, inertias and constraint rows of a state: all inputs of the right-hand sides.
void see(const Model& model, const PenaltyModel& body, const BodyState& state, State& joints, Workspace& ws,
         PenaltyWorkspace& pws) noexcept;

// The matrix (1), for tau > 0 A_h of (7) or (11) with the elements' C and K, and its factors; after see(). False when
// it is singular to working precision.
[[nodiscard]] bool factorize(const Model& model, const PenaltyModel& body, Workspace& ws, PenaltyWorkspace& pws,
                             double tau) noexcept;

// y = Q without row forces; y -= M x.
void put_free_forces(const Model& model, const Workspace& ws, std::span<double> y) noexcept;
void subtract_mass(const Model& model, const Workspace& ws, std::span<const double> x, std::span<double> y) noexcept;

// One row's gradient over the speeds: of two links, and of modes; or of a gear. row: index among all rows.
struct HeldRow {
  int link1 = 0, link2 = 0;
  const RowGradient& G;
  std::span<const double> modal;
  std::size_t place = 0;  // place of the first of these modes among the speeds
  const GearRow* gear = nullptr;
};
[[nodiscard]] HeldRow present_row(const PenaltyModel& body, const PenaltyWorkspace& pws, std::size_t constraint,
                                  std::size_t row) noexcept;
[[nodiscard]] HeldRow factored_row(const PenaltyModel& body, const PenaltyWorkspace& pws, std::size_t constraint,
                                   std::size_t row) noexcept;

// visit(row, its gradient) for the rows of all constraints, then of gears.
template <typename Visit>
void for_each_factored(const PenaltyModel& body, const PenaltyWorkspace& pws, Visit visit) noexcept {
  std::size_t row = 0;
  for (std::size_t i = 0; i < body.constraints.size(); ++i) {
    for (; row < static_cast<std::size_t>(body.first_row[i + 1]); ++row) visit(row, factored_row(body, pws, i, row));
  }
  for (const GearRow& gear : pws.factored_gears) {
    visit(row, HeldRow{0, 0, pws.factored[row], {}, 0, &gear});
    ++row;
  }
}
template <typename Visit>
void for_each_present(const PenaltyModel& body, const PenaltyWorkspace& pws, Visit visit) noexcept {
  std::size_t row = 0;
  for (std::size_t i = 0; i < body.constraints.size(); ++i) {
    for (; row < static_cast<std::size_t>(body.first_row[i + 1]); ++row) visit(row, present_row(body, pws, i, row));
  }
  for (const GearRow& gear : pws.gears) {
    visit(row, HeldRow{0, 0, pws.rows[row].G, {}, 0, &gear});
    ++row;
  }
}

// y -= G^T mu for one row, and G x.
void subtract_row(const HeldRow& row, double mu, std::span<double> y) noexcept;
[[nodiscard]] double along(const HeldRow& row, std::span<const double> x) noexcept;

// see(), then the matrix at h = 0, with force and target of (2) or (3) in pws. False when the matrix is singular.
[[nodiscard]] bool prepare(const Model& model, const PenaltyModel& body, const BodyState& state, State& joints,
                           Workspace& ws, PenaltyWorkspace& pws) noexcept;

// Solves (2) or (3) for a force (by u) and a target by row; writes x and the multipliers. False when the corrections
// did not become small.
[[nodiscard]] bool solve(const Model& model, const PenaltyModel& body, const Workspace& ws, PenaltyWorkspace& pws,
                         std::span<const double> force, std::span<const double> target, std::span<double> x,
                         std::span<double> multipliers) noexcept;

// Adds the forces of all active rows of the model.
void add_row_forces(const Model& model, const PenaltyModel& body, const State& joints, const Workspace& ws,
                    std::span<const double> forces, const math::BlockLdl& ldl, std::span<double> y) noexcept;

[[nodiscard]] bool advance_by_runge_kutta(const Model& model, const PenaltyModel& body, BodyState& state, State& joints,
                                          Workspace& ws, PenaltyWorkspace& pws, double h, std::span<const double> mean,
                                          std::span<const double> slope) noexcept;
[[nodiscard]] bool advance_by_trapezoid(const Model& model, const PenaltyModel& body, BodyState& state, State& joints,
                                        Workspace& ws, PenaltyWorkspace& pws, double h, std::span<const double> mean,
                                        std::span<const double> slope) noexcept;

}  // namespace slew::multibody
