// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/components/double_acting_cylinder.h"

#include <numbers>
#include "hydraulics/components/cylinder.h"
#include "hydraulics/components/cylinder_fields.h"
#include "hydraulics/components/cylinder_rules.h"

namespace slew::hydraulics {
namespace {

constexpr auto kDoubleActingCylinderFields = cylinder_fields<DoubleActingCylinderDef>(std::array{
    field<&DoubleActingCylinderDef::rod_diameter>("rod_diameter", {.dimension = Dimension::length,
                                                                   .range = kPositive,
                                                                   .presence = Presence::required,
                                                                   .doc = "diameter of the piston rod"}),
    field<&DoubleActingCylinderDef::rod_length>("rod_length", {.dimension = Dimension::length,
                                                               .range = kNotNegative,
                                                               .presence = Presence::required,
                                                               .doc = "length of the piston rod"}),
    field<&DoubleActingCylinderDef::attachment_length>(
        "attachment_length",
        {.dimension = Dimension::length, .range = kNotNegative, .doc = "length of the attachment"}),
});

void validate_cylinder(const HydraulicsDef& circuit, const ComponentDef& component, Problems& errors,
                       Problems& warnings) {
  const DoubleActingCylinderDef& def = static_cast<const DoubleActingCylinderDef&>(component);
  if (!(def.rod_diameter < def.common.piston_diameter)) {
    errors.push_back(
        {def.name + ".rod_diameter", "the rod is not thinner than the piston", "less than piston_diameter", ""});
  }
  check_cylinder(circuit, def.name, def.common, def.rod_diameter, errors, warnings);
  check_cushions(def.name, def.common, {.a = 0, .b = def.rod_diameter}, errors);
}

}  // namespace

std::optional<ActuatorDef> DoubleActingCylinderDef::actuator() const {
  const double D = common.piston_diameter, d = rod_diameter;
  ActuatorDef actuator = actuator_of(common);
  actuator.area_b = 0.25 * std::numbers::pi * (D * D - d * d);
  actuator.coordinate.offset = -(attachment_length + rod_length);
  set_cushions(common, actuator);
  return actuator;
}

ComponentType double_acting_cylinder_type() {
  return {.name = "double_acting_cylinder",
          .fields = kDoubleActingCylinderFields,
          .doc = "double-acting cylinder on a translational force",
          .make_def = []() -> std::unique_ptr<ComponentDef> { return std::make_unique<DoubleActingCylinderDef>(); },
          .validate = validate_cylinder,
          .build = [](const ComponentDef& def, CircuitBuilder& builder) -> std::unique_ptr<HydraulicComponent> {
            return make_cylinder<DoubleActingCylinderDef>(def, builder);
          }};
}

}  // namespace slew::hydraulics
