#include "hydraulics/components/double_acting_cylinder.h"

namespace slew::hydraulics {
namespace {

constexpr Field kDoubleActingCylinderFields[] = {
    field<&DoubleActingCylinderDef::force>(
        "force",
        {.presence = Presence::required, .reference = "force", .doc = "force element that the cylinder drives"}),
    field<&DoubleActingCylinderDef::friction_curve>(
        "friction_curve", {.reference = "curve", .doc = "friction coefficient over piston speed"}),
    field<&DoubleActingCylinderDef::port_a>(
        "port_a", {.presence = Presence::required, .reference = "volume", .doc = "volume at port A"}),
    field<&DoubleActingCylinderDef::port_b>(
        "port_b", {.presence = Presence::required, .reference = "volume", .doc = "volume at port B"}),
    field<&DoubleActingCylinderDef::piston_diameter>("piston_diameter", {.dimension = Dimension::length,
                                                                         .range = kPositive,
                                                                         .presence = Presence::required,
                                                                         .doc = "diameter of the piston"}),
    field<&DoubleActingCylinderDef::rod_diameter>("rod_diameter", {.dimension = Dimension::length,
                                                                   .range = kPositive,
                                                                   .presence = Presence::required,
                                                                   .doc = "diameter of the piston rod"}),
    field<&DoubleActingCylinderDef::piston_length>("piston_length", {.dimension = Dimension::length,
                                                                     .range = kNotNegative,
                                                                     .presence = Presence::required,
                                                                     .doc = "length of the piston"}),
    field<&DoubleActingCylinderDef::chamber_length>("chamber_length", {.dimension = Dimension::length,
                                                                       .range = kPositive,
                                                                       .presence = Presence::required,
                                                                       .doc = "inner length of the barrel"}),
    field<&DoubleActingCylinderDef::rod_length>("rod_length", {.dimension = Dimension::length,
                                                               .range = kNotNegative,
                                                               .presence = Presence::required,
                                                               .doc = "length of the piston rod"}),
    field<&DoubleActingCylinderDef::attachment_length>(
        "attachment_length",
        {.dimension = Dimension::length, .range = kNotNegative, .doc = "length of the attachment"}),
    field<&DoubleActingCylinderDef::minimum_stroke>("minimum_stroke", {.dimension = Dimension::length,
                                                                       .range = kNotNegative,
                                                                       .presence = Presence::required,
                                                                       .doc = "stroke at the lower end damper"}),
    field<&DoubleActingCylinderDef::maximum_stroke>("maximum_stroke", {.dimension = Dimension::length,
                                                                       .range = kPositive,
                                                                       .presence = Presence::required,
                                                                       .doc = "stroke at the upper end damper"}),
    field<&DoubleActingCylinderDef::bulk_modulus>(
        "bulk_modulus", {.dimension = Dimension::pressure, .range = kPositive, .doc = "bulk modulus of the barrel"}),
    field<&DoubleActingCylinderDef::cylinder_coefficient>(
        "cylinder_coefficient", {.range = kFraction, .doc = "efficiency eta; 1 - eta scales the friction curve"}),
    field<&DoubleActingCylinderDef::seal_friction>(
        "seal_friction", {.dimension = Dimension::force, .range = kNotNegative, .doc = "friction at equal pressures"}),
    field<&DoubleActingCylinderDef::leak_flow>("leak_flow", {.dimension = Dimension::volume_flow,
                                                             .range = kNotNegative,
                                                             .change = Change::live,
                                                             .doc = "leak across the piston at leak_pressure"}),
    field<&DoubleActingCylinderDef::leak_pressure>(
        "leak_pressure",
        {.dimension = Dimension::pressure, .range = kPositive, .doc = "pressure difference of leak_flow"}),
    field<&DoubleActingCylinderDef::end_stiffness>(
        "end_stiffness",
        {.dimension = Dimension::stiffness, .range = kNotNegative, .doc = "spring constant of the end dampers"}),
    field<&DoubleActingCylinderDef::end_damping>(
        "end_damping",
        {.dimension = Dimension::damping, .range = kNotNegative, .doc = "damping constant of the end dampers"}),
    field<&DoubleActingCylinderDef::dead_volume>(
        "dead_volume",
        {.dimension = Dimension::volume, .range = kNotNegative, .doc = "oil in each chamber beyond the stroke"}),
};

}  // namespace

ComponentType double_acting_cylinder_type() {
  return {.name = "double_acting_cylinder",
          .fields = kDoubleActingCylinderFields,
          .doc = "double-acting cylinder on a translational force",
          .make_def = []() -> std::unique_ptr<ComponentDef> { return std::make_unique<DoubleActingCylinderDef>(); },
          .has_control_signal = false,
          .has_ls_port = false,
          .is_actuator = true};
}

}  // namespace slew::hydraulics
