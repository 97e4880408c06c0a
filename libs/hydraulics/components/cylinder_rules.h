// Rules at load that every cylinder must keep.
#pragma once

#include <string>

#include "hydraulics/hydraulics_def.h"

namespace slew::hydraulics {

struct CylinderNumbers {
  const ComponentDef& def;
  const std::string& friction_curve;
  const std::string& port_a;
  const std::string& port_b;
  double minimum_stroke, maximum_stroke;
  double span;  // the piston's free way: chamber length less piston length
  double dead_volume;
  double end_stiffness;
  double piston_diameter, rod_diameter;
};

// Strokes in order, chambers positive over the stroke and the stops' compression, ports apart, a friction curve that
// can only brake.
void check_cylinder(const HydraulicsDef& circuit, const CylinderNumbers& cylinder, Problems& errors);

}  // namespace slew::hydraulics
