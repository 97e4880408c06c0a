// SPDX-License-Identifier: Apache-2.0
// Rules at load that every cylinder must keep.
#pragma once

#include <string>

#include "hydraulics/components/cylinder_def.h"
#include "hydraulics/hydraulics_def.h"

namespace slew::hydraulics {

// Speeds of a friction curve: one that reaches farther was typed in another unit.
struct FrictionSpeeds {
  double greatest;  // that an actuator reaches, in the unit
  const char* unit;
};

// The curve only brakes, and a warning where its speeds are beyond any. element: the actuator's name; curve: its
// friction curve, empty for none.
void check_friction_curve(const HydraulicsDef& circuit, const std::string& element, const std::string& curve,
                          const FrictionSpeeds& speeds, Problems& errors, Problems& warnings);

// Checks that strokes are in order, chambers are positive over the stroke and the stops' compression, ports differ, and
// the friction curve only brakes. name: the cylinder's; rod_diameter: 0 without a rod [m].
void check_cylinder(const HydraulicsDef& circuit, const std::string& name, const CylinderParameters& cylinder,
                    double rod_diameter, Problems& errors, Problems& warnings);

// Diameters of the rods through both chambers, 0 for none [m].
struct RodDiameters {
  double a = 0, b = 0;
};

// Cushions lie within the stroke, their plungers between rod and piston, and each has one throttle.
void check_cushions(const std::string& name, const CylinderParameters& cylinder, const RodDiameters& rods,
                    Problems& errors);

}  // namespace slew::hydraulics
