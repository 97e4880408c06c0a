// SPDX-License-Identifier: Apache-2.0
// Random mechanisms with loops for property tests and peers, the same for a seed on every run.
#pragma once

#include "tests/properties/multibody/random_tree.h"

namespace slew::multibody::testing {

// A random tree without dummies and one or two joints more, named C<number>, which the start fits. Twelve seeds on end
// have each joint type but floating among the joints that were added.
[[nodiscard]] RandomTree random_loops(unsigned seed);

// The same without Ground: nothing but the inner forces and joints acts on the bodies.
[[nodiscard]] RandomTree random_floating_loops(unsigned seed);

}  // namespace slew::multibody::testing
