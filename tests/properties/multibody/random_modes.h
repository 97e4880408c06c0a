// SPDX-License-Identifier: Apache-2.0
// Flexible bodies made of points with mass, of which every integral is a sum: for property tests.
#pragma once

#include <map>
#include <random>
#include <string>
#include <vector>

#include "multibody/flexible/modal_body.h"

namespace slew::multibody::testing {

struct MassPoint {
  double mass = 0;              // kg
  math::Vec3 x;                 // m, body frame
  std::vector<math::Vec3> phi;  // by mode
};

// By body.
using MassPoints = std::map<std::string, std::vector<MassPoint>>;

// The integrals (2) of modal_body.h over points; nodes, stiffness and root are left to the caller.
[[nodiscard]] ModalBody modal_body(const std::vector<MassPoint>& points);

// Random points and modes; node 1 at `root`, which the frame is clamped to, and three more.
[[nodiscard]] ModalBody random_modes(std::mt19937& random, math::Vec3 root, std::vector<MassPoint>& points);

// Random g of (1) in points and nodes.
void shorten(std::mt19937& random, const std::vector<MassPoint>& points, ModalBody& body);

}  // namespace slew::multibody::testing
