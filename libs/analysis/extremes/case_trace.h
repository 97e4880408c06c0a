// SPDX-License-Identifier: Apache-2.0
// What a run of a hard case leaves for the comparison with another one.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "core/time.h"

namespace slew::analysis {

struct CaseTrace {
  std::size_t columns = 0;
  std::vector<double> values;  // forces of the ports, without ports pressures, by step
  std::vector<double> last;    // all variables at the end
};

// Largest difference of any column over the largest range of any column in the second, as far as both go.
[[nodiscard]] double largest_difference(const CaseTrace& a, const CaseTrace& b);

[[nodiscard]] bool has_same_bits(const CaseTrace& a, const CaseTrace& b);

// The swing that a kick at one step starts, until `end`: its frequency by the changes of sign of the difference, its
// decay by the largest difference in the first and in the last period; none where that is too short. H: step [s].
struct Swing {
  double omega = 0, decay = 0;  // 1/s
};
[[nodiscard]] std::optional<Swing> swing_after(const CaseTrace& kicked, const CaseTrace& quiet, StepIndex kick,
                                               StepIndex end, double H);

}  // namespace slew::analysis
