// SPDX-License-Identifier: Apache-2.0
#include "multibody/flexible/node_span.h"

#include <cstddef>

namespace slew::multibody {

namespace {

class Tree {
 public:
  Tree(std::span<const int> parent, std::span<const char> is_node) noexcept : parent_(parent), is_node_(is_node) {}

  [[nodiscard]] std::optional<NodeSpan> on_one_body(int outer, int inner) const noexcept {
    if (!is_node(outer) || !is_of(inner, parent(outer))) return {};
    return NodeSpan{outer, inner, 0, outer, parent(outer)};
  }

  [[nodiscard]] std::optional<NodeSpan> across_joint(int outer, int inner) const noexcept {
    const int child = host(outer);
    if (child == 0) return {};
    const int carrier = is_node(child) ? child : parent(child);
    for (const int frame : {host(carrier), carrier}) {
      if (frame != child && is_of(inner, frame)) return NodeSpan{outer, inner, child, carrier, frame};
    }
    return {};
  }

 private:
  [[nodiscard]] bool is_node(int link) const noexcept { return is_node_[static_cast<std::size_t>(link)] != 0; }
  [[nodiscard]] int parent(int link) const noexcept { return parent_[static_cast<std::size_t>(link)]; }
  [[nodiscard]] int host(int link) const noexcept { return is_node(link) ? parent(link) : link; }
  // the frame or one of its nodes
  [[nodiscard]] bool is_of(int link, int frame) const noexcept {
    return link == frame || (is_node(link) && parent(link) == frame);
  }

  std::span<const int> parent_;
  std::span<const char> is_node_;
};

}  // namespace

std::optional<NodeSpan> node_span(int end1, int end2, std::span<const int> parent,
                                  std::span<const char> is_node) noexcept {
  const Tree tree(parent, is_node);
  if (const auto span = tree.on_one_body(end1, end2)) return span;
  if (const auto span = tree.on_one_body(end2, end1)) return span;
  if (const auto span = tree.across_joint(end1, end2)) return span;
  return tree.across_joint(end2, end1);
}

}  // namespace slew::multibody
