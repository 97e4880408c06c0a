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

// The open side of a single-acting cylinder stands on a fixed volume.
void check_open_side(const HydraulicsDef& circuit, const std::string& name, const std::string& port_b,
                     Problems& errors);

// Ports differ, and the friction curve only brakes.
void check_connections(const HydraulicsDef& circuit, const std::string& name, const CylinderParameters& cylinder,
                       Problems& errors, Problems& warnings);

// False, with an error, where the stroke limits are swapped.
bool check_stroke_order(const std::string& name, const CylinderParameters& cylinder, Problems& errors);

// A warning where the stops have no stiffness. area: of the piston [m2].
void warn_of_creep(const std::string& name, const CylinderParameters& cylinder, double area, Problems& warnings);

// A chamber at the end of the stroke where it is smallest.
struct ChamberEnd {
  char port;
  double area, length;  // m2, m
  const char* key;      // field to change
};
// Its volume is positive with the stop pressed in by a high pressure on the piston.
void check_chamber(const std::string& name, const CylinderParameters& cylinder, const ChamberEnd& end,
                   double piston_area, Problems& errors);

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
