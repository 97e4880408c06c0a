// SPDX-License-Identifier: Apache-2.0
#include "flex/reduction.h"

#include "flex/foreshortening.h"

namespace slew::flex {

using Eigen::Index;
using math::Vec3;

namespace {

Vec3 three_of(const Eigen::MatrixXd& Phi, int row, std::size_t mode) {
  const auto k = static_cast<Index>(mode);
  return {Phi(row, k), Phi(row + 1, k), Phi(row + 2, k)};
}

std::vector<ReducedNode> nodes_of(const FeModel& model, const Eigen::MatrixXd& Phi) {
  const auto m = static_cast<std::size_t>(Phi.cols());
  std::vector<ReducedNode> nodes;
  for (const FeNode& from : model.nodes) {
    ReducedNode node{from.id, from.position, {}, {}, {}};
    for (std::size_t k = 0; k < m; ++k) {
      node.phi.push_back(three_of(Phi, from.first, k));
      node.psi.push_back(from.freedoms == 6 ? three_of(Phi, from.first + 3, k) : Vec3());
    }
    nodes.push_back(std::move(node));
  }
  return nodes;
}

Source source_of(const FeModel& model, const ReductionDef& def, const CraigBampton& modes) {
  Source source;
  source.model = model.name;
  source.made_of = model.made_of;
  source.attachment = def.modes.attachment;
  source.clamped_nodes = modes.clamped_nodes;
  source.interface_nodes = modes.interface_nodes;
  source.nodes = static_cast<int>(model.nodes.size());
  source.elements = static_cast<int>(model.elements.size());
  source.boundary_freedoms = static_cast<int>(modes.boundary.size());
  source.interior_freedoms = static_cast<int>(modes.interior.size());
  source.fixed_interface_modes = static_cast<int>(modes.fixed_interface.size());
  source.stiffening = def.stiffening;
  return source;
}

}  // namespace

Reduction reduce(const FeModel& model, const ReductionDef& def) {
  const CraigBampton modes = craig_bampton(model, def.modes);
  Reduction out;
  out.source = source_of(model, def, modes);
  const std::size_t m = modes.omega.size();
  out.body.omega = modes.omega;
  out.body.K.assign(m * m, 0);
  for (std::size_t k = 0; k < m; ++k) out.body.K[k * m + k] = modes.omega[k] * modes.omega[k];
  out.body.nodes = nodes_of(model, modes.Phi);
  out.source.deviation = add_integrals(model, modes.Phi, out.body);
  if (def.stiffening == GeometricStiffening::straight_beam)
    add_foreshortening(model, modes.Phi, modes.clamped_nodes, out.body);
  out.recovery = make_recovery(model, modes.Phi);
  out.elements = uniform_elements(model);
  return out;
}

Reduction select(const Reduction& reduction, std::span<const int> ordinals) {
  return {reduction.source, select(reduction.body, ordinals), select(reduction.recovery, ordinals), reduction.elements};
}

}  // namespace slew::flex
