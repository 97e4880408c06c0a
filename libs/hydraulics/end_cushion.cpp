// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/end_cushion.h"

#include <cmath>

namespace slew::hydraulics {

math::CushionDef cushion_law(const EndCushion& cushion, const HydraulicsDef& circuit) {
  math::CushionDef law{.length = cushion.length,
                       .entry = cushion.entry_length,
                       .area = cushion.area,
                       .transition = circuit.orifice_transition,
                       .has_check_valve = cushion.has_check_valve};
  const double per_area = std::sqrt(2 / circuit.oil_density);
  for (const auto& [remaining, area] : cushion.throttle) law.conductances.push_back({remaining, area * per_area});
  return law;
}

}  // namespace slew::hydraulics
