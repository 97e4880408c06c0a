// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/components/slew_cylinder.h"

#include "hydraulics/components/cylinder.h"
#include "hydraulics/components/cylinder_fields.h"
#include "hydraulics/components/cylinder_rules.h"

namespace slew::hydraulics {
namespace {

constexpr auto kSlewCylinderFields = cylinder_fields<SlewCylinderDef>(std::array{
    field<&SlewCylinderDef::pinion_radius>("pinion_radius", {.dimension = Dimension::length,
                                                             .range = kPositive,
                                                             .presence = Presence::required,
                                                             .doc = "radius of the pinion"}),
    field<&SlewCylinderDef::stroke_offset>("stroke_offset", {.dimension = Dimension::length,
                                                             .range = kFinite,
                                                             .presence = Presence::required,
                                                             .doc = "piston position at angle zero"}),
});

void validate_slew(const HydraulicsDef& circuit, const ComponentDef& component, Problems& errors, Problems& warnings) {
  const CylinderParameters& common = static_cast<const SlewCylinderDef&>(component).common;
  check_cylinder(circuit, component.name, common, 0, errors, warnings);
  check_cushions(component.name, common, {}, errors);
}

}  // namespace

std::optional<ActuatorDef> SlewCylinderDef::actuator() const {
  ActuatorDef actuator = actuator_of(common);
  actuator.motion = Motion::rotary;
  actuator.coordinate = {.offset = stroke_offset, .ratio = pinion_radius};
  actuator.start = StartRule::mean_pressure;
  set_cushions(common, actuator);
  return actuator;
}

ComponentType slew_cylinder_type() {
  return {.name = "slew_cylinder",
          .fields = kSlewCylinderFields,
          .doc = "rack-and-pinion cylinder on a rotational force",
          .make_def = []() -> std::unique_ptr<ComponentDef> { return std::make_unique<SlewCylinderDef>(); },
          .validate = validate_slew,
          .build = [](const ComponentDef& def, CircuitBuilder& builder) -> std::unique_ptr<HydraulicComponent> {
            return make_cylinder<SlewCylinderDef>(def, builder);
          }};
}

}  // namespace slew::hydraulics
