// SPDX-License-Identifier: Apache-2.0
// Static compliance of a tip: the share of some modes in that of the whole model with the reference nodes held,
//   c = sum_k Psi_k^2/omega_k^2,   Psi = phi(tip) - R(tip) R(ref)^+ phi(ref)                             (1)
// with Psi the mode's displacement of the tip seen from the reference nodes, so that clamped and free modes are
// measured alike.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "flex/reduction.h"

namespace slew::flex {

struct TipCompliance {
  int tip = 0;                                 // id
  std::vector<int> reference_nodes;            // ids
  std::array<double, 3> full{};                // along x, y, z [m/N]
  std::vector<std::array<double, 3>> by_mode;  // terms of (1) [m/N]; empty: the reference nodes do not hold the body

  [[nodiscard]] bool is_known() const noexcept { return !by_mode.empty(); }
  // Share of the modes in `full` [1]. places: counted from 0. Pre-condition: is_known().
  [[nodiscard]] std::array<double, 3> share(std::span<const std::size_t> places) const;
};

// The tip is the last interface node; reference nodes are the clamped ones, for a free body its first interface node.
[[nodiscard]] TipCompliance tip_compliance(const FeModel& model, const Reduction& all);
// The same for other nodes. Throws InputError for one that does not exist.
[[nodiscard]] TipCompliance tip_compliance(const FeModel& model, const Reduction& all,
                                           const std::vector<int>& reference_nodes, int tip);
// Without the model: `full` is the sum over all modes, equal to the model's if none were omitted.
[[nodiscard]] TipCompliance tip_compliance(const Reduction& all);

}  // namespace slew::flex
