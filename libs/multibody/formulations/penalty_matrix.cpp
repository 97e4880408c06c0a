// SPDX-License-Identifier: Apache-2.0
// The matrix of the penalty formulations, block by block: equation (1) of body_penalty.h, and A_h of (7).
#include <array>

#include "core/index.h"
#include "multibody/formulations/link_stiffness.h"
#include "multibody/formulations/penalty_passes.h"

namespace slew::multibody {

using math::Vec3;

namespace {

std::array<double, kLinkSpeeds> spatial(Vec3 v, Vec3 w) noexcept {
  return {v[0], v[1], v[2], w[0], w[1], w[2]};
}

// Sum of weighted squares of rows between two links.
class RowBlocks {
 public:
  void add(const RowGradient& G, double weight) noexcept {
    const auto one = spatial(G.v1, G.w1), two = spatial(G.v2, G.w2);
    for (std::size_t r = 0; r < kLinkSpeeds; ++r) {
      for (std::size_t c = 0; c < kLinkSpeeds; ++c) {
        const std::size_t k = r * kLinkSpeeds + c;
        // symmetric to the bit
        own1_[k] += weight * (one[r] * one[c]);
        own2_[k] += weight * (two[r] * two[c]);
        between_[k] += weight * (one[r] * two[c]);
      }
    }
  }
  void put(int link1, int link2, math::BlockLdl& ldl) const noexcept {
    if (link1 > 0) ldl.add_diagonal(link1 - 1, own1_);
    if (link2 > 0) ldl.add_diagonal(link2 - 1, own2_);
    if (link1 > 0 && link2 > 0) ldl.add_coupling(link1 - 1, link2 - 1, between_);
  }

 private:
  SpatialBlock own1_{}, own2_{}, between_{};
};

// blocks of links into the matrix of links
class PenaltyMatrix final : public LinkMatrix {
 public:
  explicit PenaltyMatrix(math::BlockLdl& ldl) noexcept : ldl_(ldl) {}
  void add(int row_link, int column_link, const SpatialBlock& block) noexcept override {
    if (row_link == column_link) {
      ldl_.add_diagonal(row_link - 1, block);
    } else {
      ldl_.add_coupling(row_link - 1, column_link - 1, block);
    }
  }

 private:
  math::BlockLdl& ldl_;
};

// products of the ends of a gear's row; a link at two ends has both, and their cross products
void add_gear(const GearRow& gear, double alpha, math::BlockLdl& ldl) noexcept {
  for (std::size_t i = 0; i < gear.links.size(); ++i) {
    for (std::size_t j = 0; j < gear.links.size(); ++j) {
      const int row = gear.links[i], column = gear.links[j];
      // each pair of different links once
      if (row <= 0 || column <= 0 || row < column) continue;
      const auto one = spatial(gear.v[i], gear.w[i]), two = spatial(gear.v[j], gear.w[j]);
      SpatialBlock block;
      for (std::size_t r = 0; r < kLinkSpeeds; ++r) {
        for (std::size_t c = 0; c < kLinkSpeeds; ++c) block[r * kLinkSpeeds + c] = alpha * (one[r] * two[c]);
      }
      if (row == column) {
        ldl.add_diagonal(row - 1, block);
      } else {
        ldl.add_coupling(row - 1, column - 1, block);
      }
    }
  }
}

// the squares of a node's rows along its modes, and their products with the links
void add_modal_rows(const Model& model, const PenaltyModel& body, std::size_t index, PenaltyWorkspace& pws) noexcept {
  const Constraint& constraint = body.constraints[index];
  const auto part = at(model.nodes[at(constraint.node)].part);
  for (std::size_t row = at(body.first_row[index]); row < at(body.first_row[index + 1]); ++row) {
    const HeldRow held = factored_row(body, pws, index, row);
    const auto one = spatial(held.G.v1, held.G.w1), two = spatial(held.G.v2, held.G.w2);
    const double alpha = body.alpha[row];
    for (const ModalBlock& block : body.modal) {
      if (block.part != part) continue;
      const auto add = [&](int node, std::span<const double> other) {
        ModalWide wide;
        for (std::size_t k = 0; k < block.count; ++k) {
          for (std::size_t c = 0; c < other.size(); ++c) {
            wide[k * other.size() + c] = alpha * (held.modal[block.first + k] * other[c]);
          }
        }
        const std::span<const double> used(wide.data(), block.count * other.size());
        if (node == block.node) {
          pws.ldl.add_diagonal(node, used);
        } else {
          pws.ldl.add_coupling(block.node, node, used);
        }
      };
      for (const ModalBlock& other : body.modal) {
        if (other.part == part && other.node <= block.node)
          add(other.node, held.modal.subspan(other.first, other.count));
      }
      if (held.link1 > 0) add(held.link1 - 1, one);
      if (held.link2 > 0) add(held.link2 - 1, two);
    }
  }
}

// pulls of the link's own weight and inertia at its centre of mass, and of the multipliers: light links between heavy
// ones are strings
void add_pulls(const Model& model, const PenaltyModel& body, const Workspace& ws, const PenaltyWorkspace& pws,
               double weight, LinkMatrix& matrix) noexcept {
  for (std::size_t link = 1; link < model.links.size(); ++link) {
    if (!(model.links[link].mass > 0)) continue;
    const double* udot = pws.end_udot.data() + kLinkSpeeds * (link - 1);
    const LinkMotion& m = ws.motion[link];
    const Vec3 c = m.R * model.links[link].h_L * (1 / model.links[link].mass);
    const Vec3 a = Vec3(udot[0], udot[1], udot[2]) + cross({udot[3], udot[4], udot[5]}, c) + cross(m.w, cross(m.w, c));
    add_pull(static_cast<int>(link), c, (model.gravity - a) * model.links[link].mass, weight, matrix);
  }
  for (std::size_t i = 0; i < body.constraints.size(); ++i) {
    const Constraint& constraint = body.constraints[i];
    Vec3 T;
    for (std::size_t row = at(body.first_row[i]); row < at(body.first_row[i + 1]); ++row) {
      T += pws.rows[row].G.v2 * pws.multipliers[row];
    }
    // both pulled at the point of frame 2
    const LinkMotion& link2 = ws.motion[at(constraint.link2)];
    const Vec3 s2 = link2.R * constraint.p_L2;
    add_pull(constraint.link1, link2.p + s2 - ws.motion[at(constraint.link1)].p, T, weight, matrix);
    add_pull(constraint.link2, s2, -T, weight, matrix);
  }
}

}  // namespace

bool factorize(const Model& model, const PenaltyModel& body, Workspace& ws, PenaltyWorkspace& pws,
               double tau) noexcept {
  pws.ldl.clear();
  PenaltyMatrix matrix(pws.ldl);
  add_masses(model, ws, matrix);
  add_modal_masses(
      model, ws, body.modal, [](int) { return kLinkSpeeds; }, pws.ldl);
  pws.factored_modal = pws.modal;
  for (std::size_t i = 0; i < body.constraints.size(); ++i) {
    const Constraint& constraint = body.constraints[i];
    RowBlocks blocks;
    for (std::size_t row = at(body.first_row[i]); row < at(body.first_row[i + 1]); ++row) {
      pws.factored[row] = pws.rows[row].G;
      blocks.add(pws.factored[row], body.alpha[row]);
    }
    blocks.put(constraint.link1, constraint.link2, pws.ldl);
    if (constraint.node >= 0) add_modal_rows(model, body, i, pws);
  }
  pws.factored_gears = pws.gears;
  const std::size_t first_gear = pws.rows.size() - pws.gears.size();
  for (std::size_t k = 0; k < pws.gears.size(); ++k) add_gear(pws.gears[k], body.alpha[first_gear + k], pws.ldl);
  if (tau > 0) {
    const ChangeWeights weights{.position = tau * tau, .rate = tau};
    // contacts are resolved by parts of the sub-step instead (contact_rate.h)
    add_stiffness(model, ws, weights, matrix);
    add_modal_stiffness(model, body.modal, weights, ws, pws.ldl);
    add_pulls(model, body, ws, pws, weights.position, matrix);
  }
  return pws.ldl.factorize(0);  // no closing nodes
}

}  // namespace slew::multibody
