// SPDX-License-Identifier: Apache-2.0
#include "scene/segment_chain.h"

#include <utility>

namespace slew::scene {

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
