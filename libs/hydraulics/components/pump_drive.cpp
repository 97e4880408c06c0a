// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/components/pump_drive.h"

namespace slew::hydraulics {

void check_drive(const HydraulicsDef& circuit, const std::string& pump, const PumpDriveParameters& drive, double speed,
                 Problems& errors) {
  if (drive.engine.empty()) {
    if (speed > 0) return;
    errors.push_back({pump + ".speed", "nothing drives the pump", "a speed above 0, or an engine", ""});
    return;
  }
  for (const auto& component : circuit.components) {
    if (component->name != drive.engine || component->shaft()) continue;
    errors.push_back({pump + ".engine", "'" + drive.engine + "' is no engine", "a component of type engine", ""});
  }
}

}  // namespace slew::hydraulics
