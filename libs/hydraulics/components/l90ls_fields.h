// SPDX-License-Identifier: Apache-2.0
// Field table of the L90LS valve.
#pragma once

#include "core/field.h"
#include "hydraulics/components/l90ls_valve.h"

namespace slew::hydraulics {

inline constexpr Range kL90OverlapRange{.min = 0, .max = 0.99, .min_is_open = false, .max_is_open = false};

inline constexpr ReadBy kL90ReadByAntiCavitation[] = {
    read_by_set<&L90lsValveDef::anti_cavitation_flow>("anti_cavitation_flow", "anti_cavitation_flow above 0")};

inline constexpr Field kL90lsValveFields[] = {
    field<&L90lsValveDef::port_p>("port_p",
                                  {.presence = Presence::required, .reference = "volume", .doc = "volume at port P"}),
    field<&L90lsValveDef::port_a>("port_a",
                                  {.presence = Presence::required, .reference = "volume", .doc = "volume at port A"}),
    field<&L90lsValveDef::port_b>("port_b",
                                  {.presence = Presence::required, .reference = "volume", .doc = "volume at port B"}),
    field<&L90lsValveDef::port_t>("port_t",
                                  {.presence = Presence::required, .reference = "volume", .doc = "volume at port T"}),
    field<&L90lsValveDef::overlap>("overlap", {.range = kL90OverlapRange,
                                               .change = Change::live,
                                               .doc = "positive overlap of the spool, fraction of its travel"}),
    field<&L90lsValveDef::maximum_control_signal>(
        "maximum_control_signal",
        {.dimension = Dimension::electric_signal, .range = kPositive, .doc = "largest control signal"}),
    field<&L90lsValveDef::nominal_control_signal>(
        "nominal_control_signal",
        {.dimension = Dimension::electric_signal, .range = kPositive, .doc = "control signal at nominal flow"}),
    field<&L90lsValveDef::nominal_flow_pa>("nominal_flow_pa", {.dimension = Dimension::volume_flow,
                                                               .range = kPositive,
                                                               .change = Change::live,
                                                               .doc = "flow of edge P-A at nominal_pressure_drop"}),
    field<&L90lsValveDef::nominal_flow_at>("nominal_flow_at", {.dimension = Dimension::volume_flow,
                                                               .range = kPositive,
                                                               .change = Change::live,
                                                               .doc = "flow of edge A-T at nominal_pressure_drop"}),
    field<&L90lsValveDef::nominal_flow_pb>("nominal_flow_pb", {.dimension = Dimension::volume_flow,
                                                               .range = kPositive,
                                                               .change = Change::live,
                                                               .doc = "flow of edge P-B at nominal_pressure_drop"}),
    field<&L90lsValveDef::nominal_flow_bt>("nominal_flow_bt", {.dimension = Dimension::volume_flow,
                                                               .range = kPositive,
                                                               .change = Change::live,
                                                               .doc = "flow of edge B-T at nominal_pressure_drop"}),
    field<&L90lsValveDef::nominal_pressure_drop>(
        "nominal_pressure_drop",
        {.dimension = Dimension::pressure, .range = kPositive, .doc = "pressure drop of the nominal flows"}),
    field<&L90lsValveDef::leak_flow>("leak_flow", {.dimension = Dimension::volume_flow,
                                                   .range = kNotNegative,
                                                   .change = Change::live,
                                                   .doc = "leak of each edge at leak_pressure"}),
    field<&L90lsValveDef::leak_pressure>(
        "leak_pressure",
        {.dimension = Dimension::pressure, .range = kPositive, .doc = "pressure difference of the leak flows"}),
    field<&L90lsValveDef::opening_pressure_rise>("opening_pressure_rise",
                                                 {.dimension = Dimension::pressure,
                                                  .range = kPositive,
                                                  .doc = "supply above load at which the lock-hold is fully open"}),
    field<&L90lsValveDef::step_response>(
        "step_response",
        {.dimension = Dimension::time, .range = kPositive, .doc = "three time constants of the opening"}),
    field<&L90lsValveDef::compensator_pressure>("compensator_pressure",
                                                {.dimension = Dimension::pressure,
                                                 .range = kPositive,
                                                 .change = Change::live,
                                                 .doc = "drop that the compensator holds across the metering edge"}),
    field<&L90lsValveDef::compensator_flow>("compensator_flow",
                                            {.dimension = Dimension::volume_flow,
                                             .range = kPositive,
                                             .doc = "flow of the open compensator at compensator_pressure_drop"}),
    field<&L90lsValveDef::compensator_pressure_drop>(
        "compensator_pressure_drop",
        {.dimension = Dimension::pressure, .range = kPositive, .doc = "pressure drop of compensator_flow"}),
    field<&L90lsValveDef::shock_pressure_a>("shock_pressure_a", {.dimension = Dimension::pressure,
                                                                 .range = kPositive,
                                                                 .change = Change::live,
                                                                 .doc = "setting of the shock valve at A, above tank"}),
    field<&L90lsValveDef::shock_pressure_b>("shock_pressure_b", {.dimension = Dimension::pressure,
                                                                 .range = kPositive,
                                                                 .change = Change::live,
                                                                 .doc = "setting of the shock valve at B, above tank"}),
    field<&L90lsValveDef::shock_flow>("shock_flow",
                                      {.dimension = Dimension::volume_flow,
                                       .range = kPositive,
                                       .doc = "flow of a shock valve at shock_pressure_rise above its setting"}),
    field<&L90lsValveDef::shock_pressure_rise>("shock_pressure_rise",
                                               {.dimension = Dimension::pressure,
                                                .range = kPositive,
                                                .doc = "rise above the setting that opens a shock valve fully"}),
    field<&L90lsValveDef::anti_cavitation_flow>(
        "anti_cavitation_flow", {.dimension = Dimension::volume_flow,
                                 .range = kNotNegative,
                                 .doc = "flow of an anti-cavitation valve at anti_cavitation_pressure_drop"}),
    field<&L90lsValveDef::anti_cavitation_pressure_drop>("anti_cavitation_pressure_drop",
                                                         {.dimension = Dimension::pressure,
                                                          .range = kPositive,
                                                          .read_by = kL90ReadByAntiCavitation,
                                                          .doc = "pressure drop of anti_cavitation_flow"}),
    field<&L90lsValveDef::anti_cavitation_crack_pressure>("anti_cavitation_crack_pressure",
                                                          {.dimension = Dimension::pressure,
                                                           .range = kNotNegative,
                                                           .read_by = kL90ReadByAntiCavitation,
                                                           .doc = "pressure drop that opens an anti-cavitation valve"}),
    field<&L90lsValveDef::maximum_ls_pressure_a>("maximum_ls_pressure_a",
                                                 {.dimension = Dimension::pressure,
                                                  .range = kPositive,
                                                  .change = Change::live,
                                                  .doc = "limit of the load-sensing pressure of port A, above tank"}),
    field<&L90lsValveDef::maximum_ls_pressure_b>("maximum_ls_pressure_b",
                                                 {.dimension = Dimension::pressure,
                                                  .range = kPositive,
                                                  .change = Change::live,
                                                  .doc = "limit of the load-sensing pressure of port B, above tank"}),
};

}  // namespace slew::hydraulics
