// SPDX-License-Identifier: Apache-2.0
#include "multibody/flexible/deflection.h"

#include <algorithm>
#include <cstddef>

namespace slew::multibody {

using math::Vec3;

Vec3 deflection(const ModalNode& node, std::span<const double> q) noexcept {
  const std::size_t modes = q.size();
  Vec3 sum;
  for (std::size_t k = 0; k < modes; ++k) sum += node.shift[k] * q[k];
  if (node.shortening.empty()) return sum;
  for (std::size_t k = 0; k < modes; ++k) {
    for (std::size_t l = 0; l < modes; ++l) sum += node.shortening[k * modes + l] * (0.5 * q[k] * q[l]);
  }
  return sum;
}

std::vector<std::size_t> widest_nodes(const ModalBody& body) {
  if (body.nodes.empty()) return {};
  std::vector<std::size_t> widest = {body.nodes.size() - 1};
  for (std::size_t k = 0; k < body.modes(); ++k) {
    std::size_t best = 0;
    for (std::size_t i = 1; i < body.nodes.size(); ++i) {
      if (norm(body.nodes[i].shift[k]) > norm(body.nodes[best].shift[k])) best = i;
    }
    if (std::find(widest.begin(), widest.end(), best) == widest.end()) widest.push_back(best);
  }
  return widest;
}

double largest_turn(const ModalBody& body, double length, std::size_t mode) noexcept {
  double largest = 0;
  for (const ModalNode& node : body.nodes) {
    largest = std::max({largest, norm(node.turn[mode]), norm(node.shift[mode]) / length});
  }
  return largest > 0 ? largest : 1;
}

double length_of(const ModalBody& body) noexcept {
  double longest = 0;
  for (std::size_t i = 0; i < body.nodes.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      longest = std::max(longest, norm(body.nodes[i].position - body.nodes[j].position));
    }
  }
  return longest;
}

LargestDeflection largest_deflection(const ModalBody& body, std::span<const std::size_t> nodes,
                                     std::span<const double> q) noexcept {
  LargestDeflection largest;
  for (const std::size_t node : nodes) {
    const double size = norm(deflection(body.nodes[node], q));
    if (size > largest.size) largest = {body.nodes[node].id, size};
  }
  return largest;
}

}  // namespace slew::multibody
