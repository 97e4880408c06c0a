// SPDX-License-Identifier: Apache-2.0
// Rules of a bushing's 6 x 6 matrices, row by row. Internal to the library; for checks at load.
#pragma once

#include <vector>

namespace slew::multibody {

struct Entry {
  int row = -1, column = -1;
};

// First entry that differs from its mirror image; row -1: none.
[[nodiscard]] Entry find_asymmetry(const std::vector<double>& matrix);

// Pre-condition: symmetric. Scaled by its diagonal first, since the entries have different units.
[[nodiscard]] bool is_positive_semidefinite(std::vector<double> matrix);

}  // namespace slew::multibody
