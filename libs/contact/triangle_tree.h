// SPDX-License-Identifier: Apache-2.0
// Triangles of a shape that does not move, in a tree of boxes: which of them may touch a box.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "math/vector3.h"

namespace slew::contact {

using Triangle = std::array<std::uint32_t, 3>;

class TriangleTree {
 public:
  TriangleTree() = default;
  // Keeps no reference. Splits at the median of the centres along the longest side, so that its depth is log2 of the
  // number of triangles, and the same triangles give the same tree.
  TriangleTree(std::span<const math::Vec3> vertices, std::span<const Triangle> triangles);

  // Calls visit(index of triangle) for those whose leaf meets the box [low, high], in the tree's order. Real-time safe
  // when `visit` is.
  template <typename Visit>
  void visit_box(math::Vec3 low, math::Vec3 high, Visit visit) const noexcept {
    if (nodes_.empty()) return;
    std::array<std::uint32_t, kMaxDepth + 1> stack;
    std::size_t waiting = 0;
    stack[waiting++] = 0;
    while (waiting > 0) {
      const Node& node = nodes_[stack[--waiting]];
      if (!node.meets(low, high)) continue;
      if (node.count == 0) {
        stack[waiting++] = node.second_child;
        stack[waiting++] = static_cast<std::uint32_t>(&node - nodes_.data()) + 1;
        continue;
      }
      for (std::uint32_t i = 0; i < node.count; ++i) visit(order_[node.first + i]);
    }
  }

 private:
  // 2^40 triangles exceed any memory
  static constexpr std::size_t kMaxDepth = 40;
  static constexpr std::size_t kLeafSize = 4;

  // the first child follows its parent
  struct Node {
    math::Vec3 low, high;
    std::uint32_t first = 0, count = 0;  // leaf: in order_
    std::uint32_t second_child = 0;
    [[nodiscard]] bool meets(math::Vec3 a, math::Vec3 b) const noexcept {
      for (int k = 0; k < 3; ++k) {
        if (a[k] > high[k] || b[k] < low[k]) return false;
      }
      return true;
    }
  };
  void split(std::span<const math::Vec3> vertices, std::span<const Triangle> triangles, std::size_t first,
             std::size_t count);

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> order_;
};

}  // namespace slew::contact
