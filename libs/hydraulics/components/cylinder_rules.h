// Rules at load that every cylinder must keep.
#pragma once

#include <string>

#include "hydraulics/components/cylinder_def.h"
#include "hydraulics/hydraulics_def.h"

namespace slew::hydraulics {

// Strokes in order, chambers positive over the stroke and the stops' compression, ports apart, a friction curve that
// can only brake. name: of the cylinder; rod_diameter: 0 for a rod on neither side [m].
void check_cylinder(const HydraulicsDef& circuit, const std::string& name, const CylinderParameters& cylinder,
                    double rod_diameter, Problems& errors);

}  // namespace slew::hydraulics
