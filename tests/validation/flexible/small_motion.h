// SPDX-License-Identifier: Apache-2.0
// Small motion of a mechanism, for frequencies of references.
#pragma once

#include <vector>

#include "multibody/model/defs.h"

namespace slew::multibody::testing {

// Squares of small motion about the start [1/s2], ascending: accelerations that displacements cause, by differences,
// are -M^-1 K.
[[nodiscard]] std::vector<double> squares_of(const MechanicsDef& def);

}  // namespace slew::multibody::testing
