// SPDX-License-Identifier: Apache-2.0
#include "flex/tip_compliance.h"

#include <algorithm>

namespace slew::flex {

using Eigen::Index;
using Eigen::MatrixXd;
using math::Vec3;

namespace {

// rows of phi (and psi) of the nodes by mode
MatrixXd displacements(const FeModel& model, const ReducedBody& body, const std::vector<std::size_t>& nodes) {
  Index rows = 0;
  for (const std::size_t i : nodes) rows += model.nodes[i].freedoms;
  MatrixXd u(rows, static_cast<Index>(body.modes()));
  Index row = 0;
  for (const std::size_t i : nodes) {
    for (int a = 0; a < model.nodes[i].freedoms; ++a, ++row) {
      for (std::size_t k = 0; k < body.modes(); ++k) {
        const ReducedNode& node = body.nodes[i];
        u(row, static_cast<Index>(k)) = a < 3 ? node.phi[k][a] : node.psi[k][a - 3];
      }
    }
  }
  return u;
}

std::vector<int> rows_at(const FeModel& model, const std::vector<std::size_t>& nodes) {
  std::vector<int> rows;
  for (const std::size_t i : nodes) {
    for (int a = 0; a < model.nodes[i].freedoms; ++a) rows.push_back(model.nodes[i].first + a);
  }
  return rows;
}

// (1) by direction and mode; no rows if the reference nodes leave a rigid motion free
MatrixXd seen_from(const FeModel& model, const ReducedBody& body, const std::vector<std::size_t>& reference,
                   std::size_t tip) {
  const Eigen::Matrix<double, Eigen::Dynamic, 6> R = rigid_motions(model, model.nodes[reference.front()].position);
  const std::vector<int> rows = rows_at(model, reference);
  MatrixXd held(static_cast<Index>(rows.size()), 6);
  for (std::size_t i = 0; i < rows.size(); ++i) held.row(static_cast<Index>(i)) = R.row(rows[i]);
  const SmallSolution motion = solve_small(held, displacements(model, body, reference));
  if (motion.rank < 6) return MatrixXd(0, static_cast<Index>(body.modes()));
  const MatrixXd tip_motion = displacements(model, body, {tip}).topRows(3);
  return tip_motion - R.middleRows(model.nodes[tip].first, 3) * motion.x;
}

std::vector<int> reference_of(const Source& source) {
  if (source.attachment == Attachment::clamped) return source.clamped_nodes;
  return {source.interface_nodes.front()};
}

void add_mode(TipCompliance& out, Vec3 Psi, double omega) {
  std::array<double, 3>& mode = out.by_mode.emplace_back();
  for (int a = 0; a < 3; ++a) mode[static_cast<std::size_t>(a)] = Psi[a] * Psi[a] / (omega * omega);
}

}  // namespace

std::array<double, 3> TipCompliance::share(std::span<const std::size_t> places) const {
  std::array<double, 3> sum{};
  for (std::size_t a = 0; a < 3; ++a) {
    for (const std::size_t k : places) sum[a] += by_mode[k][a];
    sum[a] = full[a] > 0 ? sum[a] / full[a] : 0;
  }
  return sum;
}

TipCompliance tip_compliance(const FeModel& model, const Reduction& all) {
  return tip_compliance(model, all, reference_of(all.source), all.source.interface_nodes.back());
}

TipCompliance tip_compliance(const FeModel& model, const Reduction& all, const std::vector<int>& reference_nodes,
                             int tip) {
  TipCompliance out{tip, reference_nodes, {}, {}};
  const std::size_t at = find_node(model, tip, "tip");
  std::vector<std::size_t> reference;
  for (const int id : reference_nodes) reference.push_back(find_node(model, id, "reference_nodes"));
  const MatrixXd Psi = seen_from(model, all.body, reference, at);
  if (Psi.rows() == 0 || std::find(reference.begin(), reference.end(), at) != reference.end()) return out;
  std::vector<int> held = rows_at(model, reference);
  std::sort(held.begin(), held.end());
  const int first = model.nodes[at].first;
  const MatrixXd full = static_answer(model, held, {first, first + 1, first + 2});
  for (int a = 0; a < 3; ++a) out.full[static_cast<std::size_t>(a)] = full(first + a, a);
  for (std::size_t k = 0; k < all.body.modes(); ++k) {
    const auto column = static_cast<Index>(k);
    add_mode(out, {Psi(0, column), Psi(1, column), Psi(2, column)}, all.body.omega[k]);
  }
  return out;
}

TipCompliance tip_compliance(const Reduction& all) {
  TipCompliance out{all.source.interface_nodes.back(), reference_of(all.source), {}, {}};
  const ReducedBody& body = all.body;
  const ReducedNode& tip = body.nodes[find_node(body, out.tip)];
  const ReducedNode& reference = body.nodes[find_node(body, out.reference_nodes.front())];
  const bool is_clamped = all.source.attachment == Attachment::clamped;
  // a node without rotations does not hold the body
  const bool turns = std::any_of(reference.psi.begin(), reference.psi.end(), [](Vec3 psi) { return norm(psi) > 0; });
  if (out.tip == reference.id || (!is_clamped && !turns)) return out;
  for (std::size_t k = 0; k < body.modes(); ++k) {
    Vec3 Psi = tip.phi[k];
    if (!is_clamped) Psi = Psi - reference.phi[k] - cross(reference.psi[k], tip.position - reference.position);
    add_mode(out, Psi, body.omega[k]);
    for (std::size_t a = 0; a < 3; ++a) out.full[a] += out.by_mode.back()[a];
  }
  return out;
}

}  // namespace slew::flex
