// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/components/double_rod_cylinder.h"

#include <numbers>
#include "hydraulics/components/cylinder.h"
#include "hydraulics/components/cylinder_fields.h"
#include "hydraulics/components/cylinder_rules.h"

namespace slew::hydraulics {
namespace {

constexpr auto kDoubleRodCylinderFields = cylinder_fields<DoubleRodCylinderDef>(std::array{
    field<&DoubleRodCylinderDef::rod_diameter>("rod_diameter", {.dimension = Dimension::length,
                                                                .range = kPositive,
                                                                .presence = Presence::required,
                                                                .doc = "diameter of the rods"}),
    field<&DoubleRodCylinderDef::rod_length>("rod_length",
                                             {.dimension = Dimension::length,
                                              .range = kNotNegative,
                                              .presence = Presence::required,
                                              .doc = "length of the rod outside of the barrel at stroke zero"}),
    field<&DoubleRodCylinderDef::attachment_length>(
        "attachment_length",
        {.dimension = Dimension::length, .range = kNotNegative, .doc = "length of the attachment"}),
});

void validate_double_rod(const HydraulicsDef& circuit, const ComponentDef& component, Problems& errors,
                         Problems& warnings) {
  const DoubleRodCylinderDef& def = static_cast<const DoubleRodCylinderDef&>(component);
  if (!(def.rod_diameter < def.common.piston_diameter)) {
    errors.push_back(
        {def.name + ".rod_diameter", "the rod is not thinner than the piston", "less than piston_diameter", ""});
  }
  check_cylinder(circuit, def.name, def.common, def.rod_diameter, errors, warnings);
  check_cushions(def.name, def.common, {.a = def.rod_diameter, .b = def.rod_diameter}, errors);
}

}  // namespace

std::optional<ActuatorDef> DoubleRodCylinderDef::actuator() const {
  ActuatorDef actuator = actuator_of(common);
  actuator.area_a = piston_area(common) - 0.25 * std::numbers::pi * rod_diameter * rod_diameter;
  actuator.area_b = actuator.area_a;
  actuator.coordinate.offset = -(attachment_length + rod_length);
  actuator.start = StartRule::mean_pressure;
  set_cushions(common, actuator);
  return actuator;
}

ComponentType double_rod_cylinder_type() {
  return {.name = "double_rod_cylinder",
          .fields = kDoubleRodCylinderFields,
          .doc = "cylinder with a rod through both ends on a translational force",
          .make_def = []() -> std::unique_ptr<ComponentDef> { return std::make_unique<DoubleRodCylinderDef>(); },
          .validate = validate_double_rod,
          .build = [](const ComponentDef& def, CircuitBuilder& builder) -> std::unique_ptr<HydraulicComponent> {
            return make_cylinder<DoubleRodCylinderDef>(def, builder);
          }};
}

}  // namespace slew::hydraulics
