// SPDX-License-Identifier: Apache-2.0
#include "multibody/flexible/build_parts.h"

#include <algorithm>
#include <cstddef>

#include "core/index.h"
#include "multibody/flexible/deflection.h"
#include "multibody/flexible/elastic_law.h"
#include "multibody/flexible/expand_nodes.h"
#include "multibody/model/topology.h"

namespace slew::multibody {

using math::Mat3;
using math::Vec3;

namespace {

std::vector<Vec3> turned(const Mat3& R, const std::vector<Vec3>& vectors) {
  std::vector<Vec3> result;
  for (const Vec3& v : vectors) result.push_back(R * v);
  return result;
}

// int (R a)(R b)^T, of which a is counted from the link's origin when p is not 0: p (int b)^T more
std::vector<Mat3> turned(const Mat3& R, const std::vector<Mat3>& moments, Vec3 p, const std::vector<Vec3>& b) {
  std::vector<Mat3> result;
  for (std::size_t k = 0; k < moments.size(); ++k) {
    result.push_back(R * moments[k] * transpose(R) + outer(p, b[k]));
  }
  return result;
}

FlexiblePart part_of(const FlexibleBodyDef& def, const Body& body) {
  const ModalBody& modes = *def.modes;
  const Mat3& R = body.R_LB;
  FlexiblePart part;
  part.name = def.body;
  part.link = body.link;
  part.modes = modes.modes();
  part.is_start_given = !def.start.empty();
  part.source = def.modes;
  part.watched = widest_nodes(modes);
  part.length = length_of(modes);
  part.C = turned(R, modes.C);
  part.G = turned(R, modes.G);
  part.Z = turned(R, modes.Z, body.p_LB, part.C);
  part.Y = turned(R, modes.Y, Vec3(), std::vector<Vec3>(modes.Y.size()));
  part.H = turned(R, modes.H, body.p_LB, part.G);
  part.mass_matrix = modes.mass_matrix;
  part.stiffness = modes.stiffness;
  part.damping = modal_damping(modes, def.relative_damping);
  part.preload.resize(part.modes);
  part.is_diagonal = has_diagonal_law(part);
  for (const Mat3& Y : part.Y) part.Y_cross.push_back(axial(Y));
  for (const Mat3& H : part.H) part.H_cross.push_back(axial(H));
  return part;
}

}  // namespace

FlexibleNode build_node(const MechanicsDef& mechanics, const JointDef& joint, const Body& flexible) {
  const auto def = std::find_if(mechanics.flexible_bodies.begin(), mechanics.flexible_bodies.end(),
                                [&](const FlexibleBodyDef& body) { return body.body == joint.body1; });
  const std::vector<ModalNode>& nodes = def->modes->nodes;
  const auto node = std::find_if(nodes.begin(), nodes.end(),
                                 [&](const ModalNode& n) { return node_name(joint.body1, n.id) == joint.name; });
  const Mat3& R = flexible.R_LB;
  return {.part = static_cast<int>(def - mechanics.flexible_bodies.begin()),
          .x = flexible.p_LB + R * node->position,
          .R = R,
          .shift = turned(R, node->shift),
          .turn = turned(R, node->turn),
          .shortening = turned(R, node->shortening)};
}

void add_parts(const MechanicsDef& mechanics, Model& model) {
  // parts by link; nodes were bound by the order of the scene
  std::vector<int> order(mechanics.flexible_bodies.size()), place(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = static_cast<int>(k);
  const auto body_of = [&](int k) { return find_body(mechanics, mechanics.flexible_bodies[at(k)].body); };
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return model.bodies[at(body_of(a))].link < model.bodies[at(body_of(b))].link; });
  for (std::size_t k = 0; k < order.size(); ++k) {
    const FlexibleBodyDef& def = mechanics.flexible_bodies[at(order[k])];
    place[at(order[k])] = static_cast<int>(k);
    FlexiblePart part = part_of(def, model.bodies[at(body_of(order[k]))]);
    part.body = body_of(order[k]);
    part.q = model.coordinate_count();
    part.u = model.speed_count();
    for (std::size_t mode = 0; mode < part.modes; ++mode) {
      model.start_q.push_back(def.start.empty() ? 0 : def.start[mode]);
      model.start_u.push_back(def.start_rates.empty() ? 0 : def.start_rates[mode]);
      model.start_is_given.push_back(0);
    }
    Link& link = model.links[at(part.link)];
    // without modes the node is its link and needs no computation
    if (part.modes == 0) {
      model.parts.push_back(std::move(part));
      continue;
    }
    if (link.part_end == link.first_part) link.first_part = static_cast<int>(k);
    link.part_end = static_cast<int>(k) + 1;
    model.parts.push_back(std::move(part));
  }
  for (FlexibleNode& node : model.nodes) node.part = place[at(node.part)];
}

}  // namespace slew::multibody
