// SPDX-License-Identifier: Apache-2.0
// The mechanisms that are timed, and their data for a peer.
#pragma once

#include <string>
#include <vector>

#include "benchmarks/peers/peer.h"
#include "multibody/formulations/formulation.h"

namespace slew::peers {

struct Case {
  std::string name;
  multibody::MechanicsDef def;
};

// The crane with the dampers of its bag; the same with two cylinders as two bodies each, whose loops a ball closes; and
// beside a box of 500 kg and 0.8 m that rests on the ground with four points. Chains of n links.
[[nodiscard]] std::vector<Case> cases();

// The links of ours, which fixed joints have merged, so that every program has the least bodies that it can have.
[[nodiscard]] Mechanism mechanism_of(const multibody::MechanicsDef& def, const multibody::Model& model);

// Our state in coordinates of the border, and our accelerations; after forward_dynamics() of the state.
[[nodiscard]] State state_of(const multibody::Model& model, const multibody::State& state,
                             const multibody::Workspace& ws);
[[nodiscard]] std::vector<double> accelerations_of(const multibody::Model& model, const multibody::State& state,
                                                   const multibody::Workspace& ws);

// States of a motion with random speeds, 5 ms apart, loops closed.
[[nodiscard]] std::vector<multibody::State> motion_of(const multibody::Model& model, int states);

}  // namespace slew::peers
