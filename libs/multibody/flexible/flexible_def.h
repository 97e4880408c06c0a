// SPDX-License-Identifier: Apache-2.0
// Definition of flexible bodies.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "multibody/flexible/modal_body.h"

namespace slew::multibody {

// Makes a body of the scene flexible. Its mass and inertia are then those of the modes' source. Attachment points of
// the body ride on the nearest node, with the distance as a rigid arm; a node can be named like a body:
// "Truck_JibBoom.Node20", its frame at the node, its axes those of the body.
struct FlexibleBodyDef {
  std::string body{};                        // name of the scene's body
  std::shared_ptr<const ModalBody> modes{};  // selected
  std::vector<double>
      relative_damping{};       // zeta by mode: 2 zeta omega on the normalised mode; one for all, or empty: 0
  std::vector<double> start{};  // q by mode; empty: static equilibrium in the start's pose, zero in a mechanism with
                                // loops
  std::vector<double> start_rates{};  // q' by mode; empty: 0
};

struct BodyDef;

// Mass, centre of mass and inertia of the undeformed body.
void take_mass(const ModalBody& modes, BodyDef& body) noexcept;

}  // namespace slew::multibody
