// SPDX-License-Identifier: Apache-2.0
// Modes in body coordinates: modal coordinates follow those of the links in BodyState, and a node's link has six speeds
// of its own, which rows tie to the deformed place of the node. Internal to the library.
//
// With V the deformed place (flexible_part.h, (1) and (2)), g the rows of a fixed joint between V and the node's link:
//   g' = G_V (v_V, w_V) + G_2 (v_2, w_2) = G_1 (v_F, w_F) + sum_k m_k u_k + G_2 (v_2, w_2)
//   G_1 = (G_V.v, G_V.w + r x G_V.v),  m_k = Phi_k . G_V.v + Psi_k . G_V.w                            (1)
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "math/block_ldl.h"
#include "multibody/constraints/constraint.h"
#include "multibody/model/state.h"

namespace slew::multibody {

// Modes of a part that one node of a block matrix holds.
struct ModalBlock {
  int node = 0;
  std::size_t part = 0;              // Model::parts
  std::size_t first = 0, count = 0;  // modes
  std::size_t place = 0;             // place of the first among all modes
};

// Appends nodes for the modes of all parts to a pattern, coupled to their frames' links and to the nodes' links, whose
// nodes are link - 1.
[[nodiscard]] std::vector<ModalBlock> add_modal_blocks(const Model& model, math::BlockKind kind,
                                                       math::BlockPattern& pattern);

[[nodiscard]] std::size_t mode_count(const Model& model) noexcept;

// Place of a part's first mode among all modes: in BodyState::u they follow the 6 (links - 1) speeds of the links.
[[nodiscard]] inline std::size_t modal_place(const Model& model, std::size_t part) noexcept {
  return static_cast<std::size_t>(model.parts[part].u - model.parts.front().u);
}

// Parts and nodes' places of the motion in ws, whose links have theirs; q, u: of all modes.
void see_parts(const Model& model, std::span<const double> q, std::span<const double> u, Workspace& ws) noexcept;

// Adds the accelerations of all modes to the wrenches and biases of update_inertia().
void add_modal_accelerations(const Model& model, std::span<const double> rate, Workspace& ws) noexcept;

// Scratch for a block of the matrix.
using ModalWide = std::array<double, static_cast<std::size_t>(math::kMaxBlock) * math::kMaxBlock>;

// A matrix over the modes of a part: the block's own, and those with the part's blocks before it.
void add_modal_pairs(const FlexiblePart& part, std::span<const ModalBlock> blocks, const ModalBlock& block,
                     std::span<const double> pairs, math::BlockLdl& ldl) noexcept;

// Masses of the modes among themselves and with their frames. size_of(link): rows of the node of a link, its six speeds
// the first.
template <typename Size>
void add_modal_masses(const Model& model, const Workspace& ws, std::span<const ModalBlock> blocks, Size size_of,
                      math::BlockLdl& ldl) noexcept {
  for (const ModalBlock& block : blocks) {
    const FlexiblePart& part = model.parts[block.part];
    const PartMotion& motion = ws.parts[block.part];
    add_modal_pairs(part, blocks, block, part.mass_matrix, ldl);
    if (part.link == 0) continue;
    ModalWide wide{};
    const auto columns = static_cast<std::size_t>(size_of(part.link));
    for (std::size_t k = 0; k < block.count; ++k) {
      for (std::size_t c = 0; c < 3; ++c) {
        wide[k * columns + c] = motion.b[block.first + k][static_cast<int>(c)];
        wide[k * columns + 3 + c] = motion.c[block.first + k][static_cast<int>(c)];
      }
    }
    ldl.add_coupling(block.node, part.link - 1, {wide.data(), block.count * columns});
  }
}

// tau D + tau sigma K of the modes, into a matrix of body coordinates.
struct ChangeWeights;
void add_modal_stiffness(const Model& model, std::span<const ModalBlock> blocks, const ChangeWeights& weights,
                         Workspace& ws, math::BlockLdl& ldl) noexcept;

// The rows of a node's joint, (1). modal: rows times modes, m_k.
void evaluate_node(const Model& model, const Constraint& joint, Workspace& ws, std::span<RowValue> values,
                   std::span<double> modal) noexcept;

}  // namespace slew::multibody
