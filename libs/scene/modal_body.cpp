// SPDX-License-Identifier: Apache-2.0
#include "scene/modal_body.h"

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

}  // namespace slew::scene
