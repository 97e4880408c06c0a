// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/components/cylinder_rules.h"

#include <fmt/format.h>

#include <numbers>

namespace slew::hydraulics {
namespace {

constexpr FrictionSpeeds kPistonSpeeds{.greatest = 20, .unit = "m/s"};  // seals end below 15 m/s

constexpr double kStopPressure = 300e5;  // Pa, load pressure that may press the piston into its stop

// Checks the smallest volume of the chamber, with the piston in its stop and `length` of the chamber left.
void check_chamber(const std::string& name, const CylinderParameters& c, char port, double area, double length,
                   const char* key, Problems& errors) {
  const double piston_area = 0.25 * std::numbers::pi * c.piston_diameter * c.piston_diameter;
  const double compression = kStopPressure * piston_area / c.end_stiffness;
  const double volume = area * (length - compression) + c.dead_volume;
  if (volume > 0) return;
  errors.push_back({name + "." + key,
                    fmt::format("the volume of chamber {} is not positive over the stroke: {:.4g} l with the stop "
                                "compressed by {:.3g} mm",
                                port, volume * 1e3, compression * 1e3),
                    "a stroke inside the chamber, a stiffer stop or a dead volume", ""});
}

}  // namespace

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
  if (c.port_a == c.port_b) {
    errors.push_back({name + ".port_b", "both ports are connected to '" + c.port_a + "'", "two volumes", ""});
  }
  check_friction_curve(circuit, name, c.friction_curve, kPistonSpeeds, errors, warnings);
  if (!(c.piston_travel() > 0)) {
    errors.push_back(
        {name + ".chamber_length", "the chamber is not longer than the piston", "more than piston_length", ""});
    return;
  }
  if (!(c.minimum_stroke < c.maximum_stroke)) {
    errors.push_back({name + ".maximum_stroke",
                      fmt::format("the stroke limits are swapped: minimum {:.4g} m, maximum {:.4g} m", c.minimum_stroke,
                                  c.maximum_stroke),
                      "more than minimum_stroke", ""});
    return;
  }
  const double D = c.piston_diameter, d = rod_diameter;
  check_chamber(name, c, 'A', 0.25 * std::numbers::pi * D * D, c.minimum_stroke, "minimum_stroke", errors);
  if (d < D) {
    check_chamber(name, c, 'B', 0.25 * std::numbers::pi * (D * D - d * d), c.piston_travel() - c.maximum_stroke,
                  "maximum_stroke", errors);
  }
}

}  // namespace slew::hydraulics
