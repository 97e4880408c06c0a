// SPDX-License-Identifier: Apache-2.0
// Deflection of flexible bodies.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "multibody/flexible/modal_body.h"

namespace slew::multibody {

// phi q + 1/2 g q q of a node [m], body frame. q: by mode. No allocation.
[[nodiscard]] math::Vec3 deflection(const ModalNode& node, std::span<const double> q) noexcept;

// Beyond it small-deflection theory is off by more than a percent.
inline constexpr double kSmallDeflection = 0.1;  // share of the body's length
// A node can move by twice the body's length from its undeformed place; half as much again allows for a theory that
// lengthens bent bodies.
inline constexpr double kLostDeflection = 3;  // in body lengths

// Nodes that move most in one of the modes, and the last node: their number grows with the modes, not the nodes.
[[nodiscard]] std::vector<std::size_t> widest_nodes(const ModalBody& body);

// Largest rotation of a node [rad] per unit of a mode, or displacement over `length`; 1: the mode moves no node. A
// slender body's mode of torsion turns its tip by hundreds of radians per unit.
[[nodiscard]] double largest_turn(const ModalBody& body, double length, std::size_t mode) noexcept;

// Largest distance between two nodes [m].
[[nodiscard]] double length_of(const ModalBody& body) noexcept;

struct LargestDeflection {
  std::int64_t node = 0;  // id
  double size = 0;        // m
};
// Largest deflection of some nodes. No allocation.
[[nodiscard]] LargestDeflection largest_deflection(const ModalBody& body, std::span<const std::size_t> nodes,
                                                   std::span<const double> q) noexcept;

}  // namespace slew::multibody
