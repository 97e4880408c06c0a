#include "hydraulics/components/slew_cylinder.h"

namespace slew::hydraulics {
namespace {

constexpr Field kSlewCylinderFields[] = {
    field<&SlewCylinderDef::force>(
        "force",
        {.presence = Presence::required, .reference = "force", .doc = "force element that the cylinder drives"}),
    field<&SlewCylinderDef::friction_curve>("friction_curve",
                                            {.reference = "curve", .doc = "friction coefficient over piston speed"}),
    field<&SlewCylinderDef::port_a>("port_a",
                                    {.presence = Presence::required, .reference = "volume", .doc = "volume at port A"}),
    field<&SlewCylinderDef::port_b>("port_b",
                                    {.presence = Presence::required, .reference = "volume", .doc = "volume at port B"}),
    field<&SlewCylinderDef::piston_diameter>("piston_diameter", {.dimension = Dimension::length,
                                                                 .range = kPositive,
                                                                 .presence = Presence::required,
                                                                 .doc = "diameter of the piston"}),
    field<&SlewCylinderDef::piston_length>("piston_length", {.dimension = Dimension::length,
                                                             .range = kNotNegative,
                                                             .presence = Presence::required,
                                                             .doc = "length of the double piston"}),
    field<&SlewCylinderDef::chamber_length>("chamber_length", {.dimension = Dimension::length,
                                                               .range = kPositive,
                                                               .presence = Presence::required,
                                                               .doc = "inner length of the barrel"}),
    field<&SlewCylinderDef::pinion_radius>("pinion_radius", {.dimension = Dimension::length,
                                                             .range = kPositive,
                                                             .presence = Presence::required,
                                                             .doc = "radius of the pinion"}),
    field<&SlewCylinderDef::stroke_offset>("stroke_offset", {.dimension = Dimension::length,
                                                             .range = kFinite,
                                                             .presence = Presence::required,
                                                             .doc = "piston position at angle zero"}),
    field<&SlewCylinderDef::minimum_stroke>("minimum_stroke", {.dimension = Dimension::length,
                                                               .range = kNotNegative,
                                                               .presence = Presence::required,
                                                               .doc = "stroke at the lower end damper"}),
    field<&SlewCylinderDef::maximum_stroke>("maximum_stroke", {.dimension = Dimension::length,
                                                               .range = kPositive,
                                                               .presence = Presence::required,
                                                               .doc = "stroke at the upper end damper"}),
    field<&SlewCylinderDef::bulk_modulus>(
        "bulk_modulus", {.dimension = Dimension::pressure, .range = kPositive, .doc = "bulk modulus of the barrel"}),
    field<&SlewCylinderDef::cylinder_coefficient>(
        "cylinder_coefficient", {.range = kFraction, .doc = "efficiency eta; 1 - eta scales the friction curve"}),
    field<&SlewCylinderDef::seal_friction>(
        "seal_friction", {.dimension = Dimension::force, .range = kNotNegative, .doc = "friction at equal pressures"}),
    field<&SlewCylinderDef::leak_flow>("leak_flow", {.dimension = Dimension::volume_flow,
                                                     .range = kNotNegative,
                                                     .change = Change::live,
                                                     .doc = "leak across the piston at leak_pressure"}),
    field<&SlewCylinderDef::leak_pressure>(
        "leak_pressure",
        {.dimension = Dimension::pressure, .range = kPositive, .doc = "pressure difference of leak_flow"}),
    field<&SlewCylinderDef::end_stiffness>(
        "end_stiffness",
        {.dimension = Dimension::stiffness, .range = kNotNegative, .doc = "spring constant of the end dampers"}),
    field<&SlewCylinderDef::end_damping>(
        "end_damping",
        {.dimension = Dimension::damping, .range = kNotNegative, .doc = "damping constant of the end dampers"}),
    field<&SlewCylinderDef::dead_volume>(
        "dead_volume",
        {.dimension = Dimension::volume, .range = kNotNegative, .doc = "oil in each chamber beyond the stroke"}),
};

}  // namespace

ComponentType slew_cylinder_type() {
  return {.name = "slew_cylinder",
          .fields = kSlewCylinderFields,
          .doc = "rack-and-pinion cylinder on a rotational force",
          .make_def = []() -> std::unique_ptr<ComponentDef> { return std::make_unique<SlewCylinderDef>(); },
          .has_control_signal = false,
          .has_ls_port = false,
          .is_actuator = true};
}

}  // namespace slew::hydraulics
