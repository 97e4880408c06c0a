// SPDX-License-Identifier: Apache-2.0
// Curves as a MAT-file (level 5, compressed) for MATLAB, Octave and scipy.io.
//
// One struct for each curve: name (as in the session), unit, time [s], value (columns of equal length). It is called
// like the curve, made valid for MATLAB: "Cyl_Lift.force" is Cyl_Lift_force. One more struct, `recording`, has the
// origin of the curves.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/status.h"
#include "plotting/series.h"

namespace slew::plotting {

struct MatOrigin {
  std::string scene, session, session_id, build;
  double step = 0;  // s
};

// Names of MATLAB variables, one for each curve and none twice: letters, digits and '_', a letter first, at most 63, no
// keyword of the language. Names that differ only in replaced characters get _2, _3 ...
[[nodiscard]] std::vector<std::string> mat_names(std::span<const Series> series);

// Writes a new file or replaces one, and reads it back. Errors: storage; bad_input for a curve that is too long for the
// format.
[[nodiscard]] Status export_mat(std::span<const Series> series, const MatOrigin& origin,
                                const std::filesystem::path& path);

}  // namespace slew::plotting
