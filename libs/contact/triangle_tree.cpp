// SPDX-License-Identifier: Apache-2.0
#include "contact/triangle_tree.h"

#include <algorithm>
#include <numeric>

namespace slew::contact {

using math::Vec3;

TriangleTree::TriangleTree(std::span<const Vec3> vertices, std::span<const Triangle> triangles)
    : order_(triangles.size()) {
  std::iota(order_.begin(), order_.end(), 0u);
  if (!triangles.empty()) split(vertices, triangles, 0, triangles.size());
}

void TriangleTree::split(std::span<const Vec3> vertices, std::span<const Triangle> triangles, std::size_t first,
                         std::size_t count) {
  const std::size_t index = nodes_.size();
  Node node;
  node.low = node.high = vertices[triangles[order_[first]][0]];
  for (std::size_t i = first; i < first + count; ++i) {
    for (const std::uint32_t corner : triangles[order_[i]]) {
      for (int k = 0; k < 3; ++k) {
        node.low.lanes[k] = std::min(node.low[k], vertices[corner][k]);
        node.high.lanes[k] = std::max(node.high[k], vertices[corner][k]);
      }
    }
  }
  const bool is_leaf = count <= kLeafSize;
  node.first = static_cast<std::uint32_t>(first);
  node.count = is_leaf ? static_cast<std::uint32_t>(count) : 0;
  nodes_.push_back(node);
  if (is_leaf) return;
  int axis = 0;
  for (int k = 1; k < 3; ++k) {
    if (node.high[k] - node.low[k] > node.high[axis] - node.low[axis]) axis = k;
  }
  const auto begin = order_.begin() + static_cast<std::ptrdiff_t>(first);
  const auto centre = [&](std::uint32_t t) {
    return vertices[triangles[t][0]][axis] + vertices[triangles[t][1]][axis] + vertices[triangles[t][2]][axis];
  };
  std::stable_sort(begin, begin + static_cast<std::ptrdiff_t>(count),
                   [&](std::uint32_t a, std::uint32_t b) { return centre(a) < centre(b); });
  split(vertices, triangles, first, count / 2);
  nodes_[index].second_child = static_cast<std::uint32_t>(nodes_.size());
  split(vertices, triangles, first + count / 2, count - count / 2);
}

}  // namespace slew::contact
