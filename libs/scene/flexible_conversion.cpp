// SPDX-License-Identifier: Apache-2.0
#include "scene/flexible_conversion.h"

#include <utility>

namespace slew::scene {

multibody::ModalBody modal_body(const flex::Reduction& reduction, std::string source) {
  const flex::ReducedBody& body = reduction.body;
  const std::size_t modes = body.modes();
  multibody::ModalBody result{.source = std::move(source),
                              .mass = body.mass,
                              .first_moment = body.s0,
                              .second_moment = body.W0,
                              .mass_matrix = std::vector<double>(modes * modes),
                              .stiffness = body.K,
                              .C = body.C,
                              .Z = body.Z,
                              .Y = body.Y,
                              .G = body.G,
                              .H = body.H};
  for (std::size_t k = 0; k < modes; ++k) result.mass_matrix[body.pair(k, k)] = 1;
  for (const flex::ReducedNode& node : body.nodes) {
    result.nodes.push_back({node.id, node.position, node.phi, node.psi, node.g});
  }
  if (!reduction.source.clamped_nodes.empty()) {
    result.root = static_cast<int>(flex::find_node(body, reduction.source.clamped_nodes.front()));
  }
  return result;
}

multibody::SegmentChain segment_chain(const flex::Reduction& reduction, int segments, std::string source) {
  const flex::FiniteSegments cut = flex::finite_segments(reduction, segments);
  multibody::SegmentChain chain;
  chain.source = std::move(source);
  chain.root = cut.root;
  chain.first_frequency = reduction.body.omega.empty() ? 0 : reduction.body.omega.front();
  for (const flex::SegmentLump& lump : cut.lumps) {
    chain.lumps.push_back({lump.station, lump.mass, lump.centre, lump.inertia});
  }
  for (const flex::SegmentConnector& c : cut.connectors) {
    const flex::ConnectorStiffness& K = c.K;
    chain.connectors.push_back(
        {c.near, c.far, c.axes, c.length, {K.k11, K.k22, K.k33, K.k44, K.k55, K.k66, K.k26, K.k35}});
  }
  for (std::size_t i = 0; i < reduction.body.nodes.size(); ++i) {
    chain.nodes.push_back({reduction.body.nodes[i].id, reduction.body.nodes[i].position, cut.lump_of[i]});
  }
  return chain;
}

}  // namespace slew::scene
