#include "hydraulics/components/relief_valve.h"

namespace slew::hydraulics {
namespace {

constexpr Field kReliefValveFields[] = {
    field<&ReliefValveDef::port_1>(
        "port_1", {.presence = Presence::required, .reference = "volume", .doc = "volume at the inlet"}),
    field<&ReliefValveDef::port_2>("port_2", {.presence = Presence::required,
                                              .reference = "volume",
                                              .doc = "volume at the outlet; the setting is relative to it"}),
    field<&ReliefValveDef::port_3>("port_3",
                                   {.reference = "volume", .doc = "volume that pilots the valve; port_1 when absent"}),
    field<&ReliefValveDef::nominal_flow>("nominal_flow", {.dimension = Dimension::volume_flow,
                                                          .range = kPositive,
                                                          .presence = Presence::required,
                                                          .change = Change::live,
                                                          .doc = "flow of the open valve at nominal_pressure_drop"}),
    field<&ReliefValveDef::nominal_pressure_drop>(
        "nominal_pressure_drop",
        {.dimension = Dimension::pressure, .range = kPositive, .doc = "pressure drop of nominal_flow"}),
    field<&ReliefValveDef::setting_pressure>("setting_pressure", {.dimension = Dimension::pressure,
                                                                  .range = kPositive,
                                                                  .presence = Presence::required,
                                                                  .change = Change::live,
                                                                  .doc = "crack pressure above the outlet"}),
    field<&ReliefValveDef::opening_pressure_rise>("opening_pressure_rise",
                                                  {.dimension = Dimension::pressure,
                                                   .range = kPositive,
                                                   .doc = "rise above the setting that opens the valve fully"}),
    field<&ReliefValveDef::step_response>(
        "step_response",
        {.dimension = Dimension::time, .range = kPositive, .doc = "three time constants of the opening"}),
};

}  // namespace

ComponentType relief_valve_type() {
  return {.name = "relief_valve",
          .fields = kReliefValveFields,
          .doc = "pilot-operated pressure relief valve",
          .make_def = []() -> std::unique_ptr<ComponentDef> { return std::make_unique<ReliefValveDef>(); },
          .has_control_signal = false,
          .has_ls_port = false,
          .is_actuator = false};
}

}  // namespace slew::hydraulics
