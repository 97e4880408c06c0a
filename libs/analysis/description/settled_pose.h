// SPDX-License-Identifier: Apache-2.0
// A machine at rest in a stated pose: its cylinders and the stated joints stay, the other joints hang.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "multibody/model/state.h"

namespace slew::analysis {

// Moves the joints that neither one of the first `ports` rows, nor a prescribed motion, nor one of `held` holds into
// their stable equilibrium (multibody/build/equilibrium.h). Joints without constraint stay, such as those of a machine
// on its tyres. held: names of joints. Result: why there is no such pose, empty if there is one.
[[nodiscard]] std::string settle_free_joints(const multibody::Model& model, std::size_t ports,
                                             std::span<const std::string> held, multibody::State& state);

}  // namespace slew::analysis
