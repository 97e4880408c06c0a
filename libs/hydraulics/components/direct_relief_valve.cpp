#include "hydraulics/components/direct_relief_valve.h"

namespace slew::hydraulics {
namespace {

constexpr Range kPoppetAngleRange{.min = 0, .max = 1.5};  // below a flat seat, pi/2

constexpr Field kDirectReliefValveFields[] = {
    field<&DirectReliefValveDef::port_1>(
        "port_1", {.presence = Presence::required, .reference = "volume", .doc = "volume at the inlet"}),
    field<&DirectReliefValveDef::port_2>(
        "port_2", {.presence = Presence::required, .reference = "volume", .doc = "volume at the outlet"}),
    field<&DirectReliefValveDef::seat_diameter>("seat_diameter", {.dimension = Dimension::length,
                                                                  .range = kPositive,
                                                                  .presence = Presence::required,
                                                                  .doc = "diameter of the seat"}),
    field<&DirectReliefValveDef::half_angle>(
        "half_angle",
        {.dimension = Dimension::angle, .range = kPoppetAngleRange, .doc = "half angle of the poppet's cone"}),
    field<&DirectReliefValveDef::crack_pressure>("crack_pressure",
                                                 {.dimension = Dimension::pressure,
                                                  .range = kPositive,
                                                  .presence = Presence::required,
                                                  .change = Change::live,
                                                  .doc = "pressure above the outlet that lifts the poppet"}),
    field<&DirectReliefValveDef::spring_constant>("spring_constant", {.dimension = Dimension::stiffness,
                                                                      .range = kPositive,
                                                                      .presence = Presence::required,
                                                                      .doc = "spring constant"}),
    field<&DirectReliefValveDef::discharge_coefficient>("discharge_coefficient",
                                                        {.range = kFractionAboveZero, .doc = "discharge coefficient"}),
    field<&DirectReliefValveDef::maximum_lift>(
        "maximum_lift", {.dimension = Dimension::length, .range = kPositive, .doc = "lift at the stop"}),
    field<&DirectReliefValveDef::flow_force>("flow_force",
                                             {.choices = kFlowForceChoices, .doc = "closing force of the jet"}),
};

}  // namespace

ComponentType direct_relief_valve_type() {
  return {.name = "direct_relief_valve",
          .fields = kDirectReliefValveFields,
          .doc = "direct-acting poppet relief valve",
          .make_def = []() -> std::unique_ptr<ComponentDef> { return std::make_unique<DirectReliefValveDef>(); },
          .has_control_signal = false,
          .has_ls_port = false,
          .is_actuator = false};
}

}  // namespace slew::hydraulics
