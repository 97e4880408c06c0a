// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/components/single_acting_cylinder.h"

#include "hydraulics/components/cylinder.h"
#include "hydraulics/components/cylinder_fields.h"
#include "hydraulics/components/cylinder_rules.h"

namespace slew::hydraulics {
namespace {

constexpr auto kSingleActingCylinderFields = cylinder_fields<SingleActingCylinderDef, CushionEnds::a>(std::array{
    field<&SingleActingCylinderDef::rod_length>("rod_length", {.dimension = Dimension::length,
                                                               .range = kNotNegative,
                                                               .presence = Presence::required,
                                                               .doc = "length of the piston rod or plunger"}),
    field<&SingleActingCylinderDef::attachment_length>(
        "attachment_length",
        {.dimension = Dimension::length, .range = kNotNegative, .doc = "length of the attachment"}),
});

void validate_single_acting(const HydraulicsDef& circuit, const ComponentDef& component, Problems& errors,
                            Problems& warnings) {
  const SingleActingCylinderDef& def = static_cast<const SingleActingCylinderDef&>(component);
  check_open_side(circuit, def.name, def.common.port_b, errors);
  check_cylinder(circuit, def.name, def.common, 0, errors, warnings);
  check_cushions(def.name, def.common, {}, errors);
}

}  // namespace

std::optional<ActuatorDef> SingleActingCylinderDef::actuator() const {
  ActuatorDef actuator = actuator_of(common);
  actuator.coordinate.offset = -(attachment_length + rod_length);
  set_cushions(common, actuator);
  return actuator;
}

ComponentType single_acting_cylinder_type() {
  return {.name = "single_acting_cylinder",
          .fields = kSingleActingCylinderFields,
          .doc = "single-acting cylinder or plunger on a translational force",
          .make_def = []() -> std::unique_ptr<ComponentDef> { return std::make_unique<SingleActingCylinderDef>(); },
          .validate = validate_single_acting,
          .build = [](const ComponentDef& def, CircuitBuilder& builder) -> std::unique_ptr<HydraulicComponent> {
            return make_cylinder<SingleActingCylinderDef>(def, builder);
          }};
}

}  // namespace slew::hydraulics
