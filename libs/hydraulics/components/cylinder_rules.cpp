// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/components/cylinder_rules.h"

#include <fmt/format.h>

#include <numbers>

namespace slew::hydraulics {
namespace {

constexpr FrictionSpeeds kPistonSpeeds{.greatest = 20, .unit = "m/s"};  // seals end below 15 m/s

constexpr double kStopPressure = 300e5;  // Pa, load pressure that may press the piston into its stop

// side: "cushion_a" or "cushion_b"
void check_cushion(const std::string& side, const CushionParameters& cushion, const CylinderParameters& cylinder,
                   double rod_diameter, Problems& errors) {
  if (cushion.length == 0) return;
  const double stroke = cylinder.maximum_stroke - cylinder.minimum_stroke, plunger = cushion.plunger_diameter;
  if (cushion.length > stroke) {
    errors.push_back(
        {side + "_length",
         fmt::format("the cushion is longer than the stroke: {:.4g} m of {:.4g} m", cushion.length, stroke),
         "at most maximum_stroke - minimum_stroke", ""});
  }
  if (cushion.entry_length > cushion.length) {
    errors.push_back({side + "_entry_length",
                      fmt::format("the plunger shuts the port over {:.4g} m, and the cushion has {:.4g} m",
                                  cushion.entry_length, cushion.length),
                      "at most the length of the cushion", ""});
  }
  if (!(plunger < cylinder.piston_diameter)) {
    errors.push_back(
        {side + "_plunger_diameter", "the plunger is not thinner than the piston", "less than piston_diameter", ""});
  } else if (plunger > 0 && plunger < rod_diameter) {
    errors.push_back({side + "_plunger_diameter", "the plunger is thinner than the rod that it sits on",
                      "rod_diameter or more, or 0 for the whole chamber", ""});
  }
  if (cushion.areas.empty() == (cushion.orifice_diameter == 0)) {
    const bool has_none = cushion.areas.empty();
    errors.push_back({side + "_orifice_diameter",
                      has_none ? "the cushion has no throttle" : "the throttle has a diameter and a table of areas",
                      has_none ? "a diameter above 0, or a table of areas" : "one of both", ""});
  }
  if (!cushion.areas.empty() && (cushion.areas.front()[0] < 0 || cushion.areas.back()[0] > cushion.length)) {
    errors.push_back({side + "_areas",
                      fmt::format("the table is over {:.4g} to {:.4g} m, and the cushion over 0 to {:.4g} m",
                                  cushion.areas.front()[0], cushion.areas.back()[0], cushion.length),
                      "remaining strokes from 0 to the length of the cushion", ""});
  }
}

}  // namespace

void check_open_side(const HydraulicsDef& circuit, const std::string& name, const std::string& port_b,
                     Problems& errors) {
  for (const VolumeDef& volume : circuit.volumes) {
    if (volume.name != port_b || volume.fixed) continue;
    errors.push_back({name + ".port_b",
                      "the open side is not open: '" + volume.name + "' is not held at a fixed pressure",
                      "a volume with fixed: true, or a double_acting_cylinder", ""});
  }
}

void check_connections(const HydraulicsDef& circuit, const std::string& name, const CylinderParameters& c,
                       Problems& errors, Problems& warnings) {
  if (c.port_a == c.port_b) {
    errors.push_back({name + ".port_b", "both ports are connected to '" + c.port_a + "'", "two volumes", ""});
  }
  check_friction_curve(circuit, name, c.friction_curve, kPistonSpeeds, errors, warnings);
}

bool check_stroke_order(const std::string& name, const CylinderParameters& c, Problems& errors) {
  if (c.minimum_stroke < c.maximum_stroke) return true;
  errors.push_back({name + ".maximum_stroke",
                    fmt::format("the stroke limits are swapped: minimum {:.4g} m, maximum {:.4g} m", c.minimum_stroke,
                                c.maximum_stroke),
                    "more than minimum_stroke", ""});
  return false;
}

void warn_of_creep(const std::string& name, const CylinderParameters& c, double area, Problems& warnings) {
  if (c.end_stiffness > 0) return;
  constexpr double kPressure = 100e5;
  const std::string creep = c.end_damping > 0
                                ? fmt::format("a piston pressed into it creeps on, by {:.3g} mm/s at {:.0f} bar",
                                              1e3 * kPressure * area / c.end_damping, kPressure * 1e-5)
                                : std::string("nothing holds a piston at the end of its stroke");
  warnings.push_back({name + ".end_stiffness", "the stop has no stiffness: " + creep,
                      "a stiffness, 5e7 N/m is the default, or an end_damping with which it creeps slowly enough", ""});
}

void check_chamber(const std::string& name, const CylinderParameters& c, const ChamberEnd& end, double piston_area,
                   Problems& errors) {
  const double compression = c.end_stiffness > 0 ? kStopPressure * piston_area / c.end_stiffness : 0;
  const double dead_volume = c.dead_volume + (end.port == 'A' ? c.dead_volume_a : c.dead_volume_b);
  const double volume = end.area * (end.length - compression) + dead_volume;
  if (volume > 0) return;
  errors.push_back({name + "." + end.key,
                    fmt::format("the volume of chamber {} is not positive over the stroke: {:.4g} l with the stop "
                                "compressed by {:.3g} mm",
                                end.port, volume * 1e3, compression * 1e3),
                    "a stroke inside the chamber, a stiffer stop or a dead volume", ""});
}

void check_cushions(const std::string& name, const CylinderParameters& cylinder, const RodDiameters& rods,
                    Problems& errors) {
  check_cushion(name + ".cushion_a", cylinder.cushion_a, cylinder, rods.a, errors);
  check_cushion(name + ".cushion_b", cylinder.cushion_b, cylinder, rods.b, errors);
}

void check_friction_curve(const HydraulicsDef& circuit, const std::string& element, const std::string& name,
                          const FrictionSpeeds& speeds, Problems& errors, Problems& warnings) {
  for (const CurveDef& curve : circuit.curves) {
    if (curve.name != name) continue;
    if (!curve.points.empty() && curve.points.back()[0] > speeds.greatest) {
      warnings.push_back({element + ".friction_curve",
                          fmt::format("the curve '{}' goes to {:g} {}, and an actuator does not exceed {:g} {}",
                                      curve.name, curve.points.back()[0], speeds.unit, speeds.greatest, speeds.unit),
                          fmt::format("arguments in {}", speeds.unit), ""});
    }
    bool is_braking = curve.odd;
    for (const auto& point : curve.points) is_braking = is_braking && point[0] >= 0 && point[1] >= 0;
    if (is_braking) return;
    errors.push_back({element + ".friction_curve", "the curve '" + curve.name + "' would drive the actuator",
                      "odd: true with coefficients >= 0 over speeds >= 0", ""});
  }
}

void check_cylinder(const HydraulicsDef& circuit, const std::string& name, const CylinderParameters& c,
                    double rod_diameter, Problems& errors, Problems& warnings) {
  check_connections(circuit, name, c, errors, warnings);
  if (!(c.piston_travel() > 0)) {
    errors.push_back(
        {name + ".chamber_length", "the chamber is not longer than the piston", "more than piston_length", ""});
    return;
  }
  if (!check_stroke_order(name, c, errors)) return;
  const double D = c.piston_diameter, d = rod_diameter;
  const double piston = 0.25 * std::numbers::pi * D * D;
  warn_of_creep(name, c, piston, warnings);
  check_chamber(name, c, {'A', piston, c.minimum_stroke, "minimum_stroke"}, piston, errors);
  if (d < D) {
    const double ring = 0.25 * std::numbers::pi * (D * D - d * d);
    check_chamber(name, c, {'B', ring, c.piston_travel() - c.maximum_stroke, "maximum_stroke"}, piston, errors);
  }
}

}  // namespace slew::hydraulics
