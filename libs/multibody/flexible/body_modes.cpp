// SPDX-License-Identifier: Apache-2.0
#include "multibody/flexible/body_modes.h"

#include <algorithm>

#include "core/index.h"
#include "multibody/formulations/link_stiffness.h"

namespace slew::multibody {

using math::Vec3;

std::size_t mode_count(const Model& model) noexcept {
  std::size_t count = 0;
  for (const FlexiblePart& part : model.parts) count += part.modes;
  return count;
}

std::vector<ModalBlock> add_modal_blocks(const Model& model, math::BlockKind kind, math::BlockPattern& pattern) {
  std::vector<ModalBlock> blocks;
  for (std::size_t k = 0; k < model.parts.size(); ++k) {
    const FlexiblePart& part = model.parts[k];
    const std::size_t first_block = blocks.size();
    for (std::size_t first = 0; first < part.modes; first += math::kMaxBlock) {
      const std::size_t count = std::min<std::size_t>(part.modes - first, math::kMaxBlock);
      const int node = static_cast<int>(pattern.nodes.size());
      pattern.nodes.push_back({static_cast<int>(count), kind});
      for (std::size_t other = first_block; other < blocks.size(); ++other) {
        pattern.couplings.emplace_back(node, blocks[other].node);
      }
      if (part.link > 0) pattern.couplings.emplace_back(node, part.link - 1);
      for (std::size_t i = 1; i < model.links.size(); ++i) {
        const Link& link = model.links[i];
        if (link.joint == LinkJoint::node && model.nodes[at(link.node)].part == static_cast<int>(k)) {
          pattern.couplings.emplace_back(node, static_cast<int>(i) - 1);
        }
      }
      blocks.push_back({node, k, first, count, modal_place(model, k) + first});
    }
  }
  return blocks;
}

void see_parts(const Model& model, std::span<const double> q, std::span<const double> u, Workspace& ws) noexcept {
  for (std::size_t k = 0; k < model.parts.size(); ++k) {
    const FlexiblePart& part = model.parts[k];
    const std::size_t place = modal_place(model, k);
    see_part(part, q.subspan(place, part.modes), u.subspan(place, part.modes), ws.motion[at(part.link)], ws.parts[k]);
  }
}

void add_modal_accelerations(const Model& model, std::span<const double> rate, Workspace& ws) noexcept {
  for (std::size_t index = 0; index < model.parts.size(); ++index) {
    const FlexiblePart& part = model.parts[index];
    PartMotion& motion = ws.parts[index];
    ArticulatedInertia& inertia = ws.inertia[at(part.link)];
    const std::span<const double> own = rate.subspan(modal_place(model, index), part.modes);
    for (std::size_t k = 0; k < part.modes; ++k) {
      inertia.f += motion.b[k] * own[k];
      inertia.n += motion.c[k] * own[k];
      for (std::size_t l = 0; l < part.modes; ++l) motion.bias[k] += part.mass_matrix[k * part.modes + l] * own[l];
    }
  }
}

void add_modal_pairs(const FlexiblePart& part, std::span<const ModalBlock> blocks, const ModalBlock& block,
                     std::span<const double> pairs, math::BlockLdl& ldl) noexcept {
  for (const ModalBlock& other : blocks) {
    if (other.part != block.part || other.node > block.node) continue;
    ModalWide wide;
    for (std::size_t k = 0; k < block.count; ++k) {
      for (std::size_t l = 0; l < other.count; ++l) {
        wide[k * other.count + l] = pairs[(block.first + k) * part.modes + other.first + l];
      }
    }
    const std::span<const double> used(wide.data(), block.count * other.count);
    if (other.node == block.node) {
      ldl.add_diagonal(block.node, used);
    } else {
      ldl.add_coupling(block.node, other.node, used);
    }
  }
}

void add_modal_stiffness(const Model& model, std::span<const ModalBlock> blocks, const ChangeWeights& weights,
                         Workspace& ws, math::BlockLdl& ldl) noexcept {
  for (const ModalBlock& block : blocks) {
    const FlexiblePart& part = model.parts[block.part];
    // E is the recursion's own
    std::vector<double>& sum = ws.parts[block.part].E;
    for (std::size_t k = 0; k < sum.size(); ++k) {
      sum[k] = weights.rate * part.damping[k] + weights.position * part.stiffness[k];
    }
    add_modal_pairs(part, blocks, block, sum, ldl);
  }
}

void evaluate_node(const Model& model, const Constraint& joint, Workspace& ws, std::span<RowValue> values,
                   std::span<double> modal) noexcept {
  const auto index = at(joint.node);
  const FlexibleNode& node = model.nodes[index];
  // from the frame's motion without accelerations, which the row adds itself
  LinkMotion frame = ws.motion[at(joint.link1)], place;
  frame.a = frame.alpha = Vec3();
  move_node(node, frame, ws.parts[at(node.part)], ws.nodes[index], place);
  evaluate(joint, place, ws.motion[at(joint.link2)], ws.drives, values);
  const NodeMotion& motion = ws.nodes[index];
  const std::size_t modes = motion.Phi.size();
  for (std::size_t row = 0; row < values.size(); ++row) {
    RowGradient& G = values[row].G;
    values[row].bias += dot(G.v1, place.a) + dot(G.w1, place.alpha);
    for (std::size_t k = 0; k < modes; ++k) {
      modal[row * modes + k] = dot(motion.Phi[k], G.v1) + dot(motion.Psi[k], G.w1);
    }
    G.w1 += cross(place.r, G.v1);
  }
}

}  // namespace slew::multibody
