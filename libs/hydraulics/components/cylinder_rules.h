// SPDX-License-Identifier: Apache-2.0
// Rules at load that every cylinder must keep.
#pragma once

#include <string>

#include "hydraulics/components/cylinder_def.h"
#include "hydraulics/hydraulics_def.h"

namespace slew::hydraulics {

// The curve only brakes. element: the actuator's name; curve: its friction curve, empty for none.
void check_friction_curve(const HydraulicsDef& circuit, const std::string& element, const std::string& curve,
                          Problems& errors);

// Checks that strokes are in order, chambers are positive over the stroke and the stops' compression, ports differ, and
// the friction curve only brakes. name: the cylinder's; rod_diameter: 0 without a rod [m].
void check_cylinder(const HydraulicsDef& circuit, const std::string& name, const CylinderParameters& cylinder,
                    double rod_diameter, Problems& errors);

}  // namespace slew::hydraulics
