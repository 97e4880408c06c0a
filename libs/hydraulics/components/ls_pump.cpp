#include "hydraulics/components/ls_pump.h"

namespace slew::hydraulics {
namespace {

constexpr Field kLsPumpFields[] = {
    field<&LsPumpDef::port_a>("port_a",
                              {.presence = Presence::required, .reference = "volume", .doc = "volume at the outlet"}),
    field<&LsPumpDef::port_b>("port_b", {.presence = Presence::required, .reference = "volume", .doc = "tank volume"}),
    field<&LsPumpDef::ls_port>(
        "ls_port", {.reference = "component", .doc = "component whose load-sensing pressure the pump follows"}),
    field<&LsPumpDef::speed>("speed", {.dimension = Dimension::angular_velocity,
                                       .range = kPositive,
                                       .presence = Presence::required,
                                       .change = Change::live,
                                       .doc = "speed of the drive"}),
    field<&LsPumpDef::displacement>("displacement", {.dimension = Dimension::displacement_volume,
                                                     .range = kPositive,
                                                     .presence = Presence::required,
                                                     .doc = "displacement at full swash"}),
    field<&LsPumpDef::mechanical_coefficient>("mechanical_coefficient",
                                              {.range = kFractionAboveZero, .doc = "hydro-mechanical efficiency"}),
    field<&LsPumpDef::volumetric_coefficient>("volumetric_coefficient",
                                              {.range = kFractionAboveZero, .doc = "volumetric efficiency"}),
    field<&LsPumpDef::controller_gain>(
        "controller_gain",
        {.dimension = Dimension::pressure_gain, .range = kPositive, .doc = "swash per pressure error"}),
    field<&LsPumpDef::time_constant>(
        "time_constant", {.dimension = Dimension::time, .range = kPositive, .doc = "time constant of the swash"}),
    field<&LsPumpDef::set_pressure>("set_pressure", {.dimension = Dimension::pressure,
                                                     .range = kPositive,
                                                     .change = Change::live,
                                                     .doc = "margin above the load-sensing pressure"}),
    field<&LsPumpDef::standby_pressure>("standby_pressure", {.dimension = Dimension::pressure,
                                                             .range = kNotNegative,
                                                             .change = Change::live,
                                                             .doc = "outlet pressure without demand, above tank"}),
    field<&LsPumpDef::maximum_ls_pressure>("maximum_ls_pressure",
                                           {.dimension = Dimension::pressure,
                                            .range = kPositive,
                                            .change = Change::live,
                                            .doc = "limit of the load-sensing pressure, above tank"}),
    field<&LsPumpDef::leak_flow>("leak_flow", {.dimension = Dimension::volume_flow,
                                               .range = kNotNegative,
                                               .change = Change::live,
                                               .doc = "leak from outlet to tank at leak_pressure"}),
    field<&LsPumpDef::leak_pressure>(
        "leak_pressure",
        {.dimension = Dimension::pressure, .range = kPositive, .doc = "pressure difference of leak_flow"}),
};

}  // namespace

ComponentType ls_pump_type() {
  return {.name = "ls_pump",
          .fields = kLsPumpFields,
          .doc = "variable-displacement pump with load-sensing controller",
          .make_def = []() -> std::unique_ptr<ComponentDef> { return std::make_unique<LsPumpDef>(); },
          .has_control_signal = false,
          .has_ls_port = false,
          .is_actuator = false};
}

}  // namespace slew::hydraulics
