// SPDX-License-Identifier: Apache-2.0
// Connection between the two points of a force in the tree: modes only, or one joint. Internal to the library.
#pragma once

#include <optional>
#include <span>

namespace slew::multibody {

// Links or merged bodies by number, 0 is Ground; names as in node_dummies.h.
struct NodeSpan {
  int outer = 0, inner = 0;  // links of B and A
  int child = 0;             // C; 0: both are on one body
  int carrier = 0, frame = 0;
};

// The span of a force whose ends lie on different links. None: more than one joint is between them. A link may be a
// node of one flexible body and the frame of another that is fixed there; then that link is C for points of the outer
// one, a joint without coordinates.
[[nodiscard]] std::optional<NodeSpan> node_span(int end1, int end2, std::span<const int> parent,
                                                std::span<const char> is_node) noexcept;

}  // namespace slew::multibody
