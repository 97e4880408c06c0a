// SPDX-License-Identifier: Apache-2.0
// The elastic forces of a flexible body's modes: from its files, or from a partner.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "core/problem.h"
#include "core/status.h"
#include "multibody/flexible/flexible_def.h"
#include "multibody/model/defs.h"

namespace slew::multibody {

struct FlexiblePart;
struct Model;

// Q - K (q - q_ref) - D (u - u_ref). Q, q_ref, u_ref: by mode; K, D: by pair of modes, symmetric. M: mass that replaces
// that of the modes if they are condensed over a step; empty: their own.
struct ElasticLaw {
  std::span<const double> Q, q_ref, u_ref;
  std::span<const double> K, D, M;
};

// D of the relative damping zeta of the modes: 2 zeta omega on a mode of unit mass (table 23 as in the errata).
// Pre-condition: zeta are as many as modes, or one, or none. Allocates.
[[nodiscard]] std::vector<double> modal_damping(const ModalBody& modes, std::span<const double> zeta);

// True if stiffness and damping couple no modes, as for modes of the whole body.
[[nodiscard]] bool has_diagonal_law(const FlexiblePart& part) noexcept;

// Replaces the part's own law. Pre-condition: its sizes are the part's. No allocation.
void set_elastic_law(Model& model, std::size_t part, const ElasticLaw& law) noexcept;

// Checks a law for the part: sizes, finite numbers, K and D symmetric, K positive definite, D without negative damping
// on its diagonal. Error bad_input: the fault.
[[nodiscard]] Status check_elastic_law(const Model& model, std::size_t part, const ElasticLaw& law);

// Problem of modes too fast for the mechanics' explicit integrator, with the model's elastic laws at its start.
// Allocates.
void check_mode_speeds(const MechanicsDef& mechanics, const Model& model, Problems& problems);

}  // namespace slew::multibody
