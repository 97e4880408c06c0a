// SPDX-License-Identifier: Apache-2.0
// Loops that start in a singular position. Internal to the library.
//
// There a row of the loop depends on the others though it does not elsewhere: lambda^T J = 0 with lambda != 0. So
// J u = 0 leaves speeds that the loop cannot go on with, and g'' = J u' + b = 0 has a solution only if
//   lambda^T b(u) = 0                                                                                   (1)
// which is quadratic in the speeds: a flat parallelogram can go on as a parallelogram or crossed, and with one crank's
// speed neither is selected. At rest (1) holds, and rounding selects.
#pragma once

#include <vector>

#include "multibody/build/assembly.h"
#include "multibody/model/state.h"

namespace slew::multibody {

// Rows that depend on others in the present position alone; ws: rows' values and factors of the start, after
// factorize_cuts() with this tolerance. Pre-condition: rows that depend on others everywhere have left the model.
[[nodiscard]] std::vector<AssemblyReport::Singular> find_singular_rows(const Model& model, double tolerance,
                                                                       Workspace& ws);

}  // namespace slew::multibody
