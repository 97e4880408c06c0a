#include "hydraulics/components/compensated_orifice.h"

namespace slew::hydraulics {
namespace {

constexpr Field kCompensatedOrificeFields[] = {
    field<&CompensatedOrificeDef::port_p>(
        "port_p", {.presence = Presence::required, .reference = "volume", .doc = "supply volume"}),
    field<&CompensatedOrificeDef::port_a>(
        "port_a", {.presence = Presence::required, .reference = "volume", .doc = "load volume"}),
    field<&CompensatedOrificeDef::port_t>("port_t", {.presence = Presence::required,
                                                     .reference = "volume",
                                                     .doc = "tank volume: reference of the load-sensing pressure"}),
    field<&CompensatedOrificeDef::area>("area", {.dimension = Dimension::area,
                                                 .range = kPositive,
                                                 .presence = Presence::required,
                                                 .doc = "area of the open orifice"}),
    field<&CompensatedOrificeDef::discharge_coefficient>("discharge_coefficient",
                                                         {.range = kFractionAboveZero, .doc = "discharge coefficient"}),
    field<&CompensatedOrificeDef::compensator_pressure>("compensator_pressure",
                                                        {.dimension = Dimension::pressure,
                                                         .range = kPositive,
                                                         .change = Change::live,
                                                         .doc = "drop that the compensator holds across the orifice"}),
    field<&CompensatedOrificeDef::opening>(
        "opening", {.range = kFraction, .change = Change::live, .doc = "opened fraction of the area"}),
};

}  // namespace

ComponentType compensated_orifice_type() {
  return {.name = "compensated_orifice",
          .fields = kCompensatedOrificeFields,
          .doc = "metering orifice with an ideal pressure compensator",
          .make_def = []() -> std::unique_ptr<ComponentDef> { return std::make_unique<CompensatedOrificeDef>(); },
          .has_control_signal = false,
          .has_ls_port = true,
          .is_actuator = false};
}

}  // namespace slew::hydraulics
