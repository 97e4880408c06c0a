#include "hydraulics/components/restrictions.h"

namespace slew::hydraulics {
namespace {

constexpr Field kBleedFields[] = {
    field<&BleedDef::port_1>("port_1", {.presence = Presence::required, .reference = "volume", .doc = "volume"}),
    field<&BleedDef::port_2>("port_2", {.presence = Presence::required, .reference = "volume", .doc = "volume"}),
    field<&BleedDef::nominal_flow>("nominal_flow", {.dimension = Dimension::volume_flow,
                                                    .range = kNotNegative,
                                                    .presence = Presence::required,
                                                    .change = Change::live,
                                                    .doc = "flow at nominal_pressure_drop"}),
    field<&BleedDef::nominal_pressure_drop>("nominal_pressure_drop", {.dimension = Dimension::pressure,
                                                                      .range = kPositive,
                                                                      .presence = Presence::required,
                                                                      .doc = "pressure drop of nominal_flow"}),
};

constexpr Field kOrificeFields[] = {
    field<&OrificeDef::port_1>("port_1", {.presence = Presence::required, .reference = "volume", .doc = "volume"}),
    field<&OrificeDef::port_2>("port_2", {.presence = Presence::required, .reference = "volume", .doc = "volume"}),
    field<&OrificeDef::diameter>(
        "diameter",
        {.dimension = Dimension::length, .range = kPositive, .presence = Presence::required, .doc = "diameter"}),
    field<&OrificeDef::discharge_coefficient>("discharge_coefficient",
                                              {.range = kFractionAboveZero, .doc = "discharge coefficient"}),
    field<&OrificeDef::opening>("opening",
                                {.range = kFraction, .change = Change::live, .doc = "opened fraction of the area"}),
};

constexpr Field kLaminarRestrictionFields[] = {
    field<&LaminarRestrictionDef::port_1>("port_1",
                                          {.presence = Presence::required, .reference = "volume", .doc = "volume"}),
    field<&LaminarRestrictionDef::port_2>("port_2",
                                          {.presence = Presence::required, .reference = "volume", .doc = "volume"}),
    field<&LaminarRestrictionDef::diameter>(
        "diameter",
        {.dimension = Dimension::length, .range = kPositive, .presence = Presence::required, .doc = "inner diameter"}),
    field<&LaminarRestrictionDef::length>(
        "length",
        {.dimension = Dimension::length, .range = kPositive, .presence = Presence::required, .doc = "length"}),
};

}  // namespace

ComponentType bleed_type() {
  return {.name = "bleed",
          .fields = kBleedFields,
          .doc = "restriction given by a nominal flow",
          .make_def = []() -> std::unique_ptr<ComponentDef> { return std::make_unique<BleedDef>(); },
          .has_control_signal = false,
          .has_ls_port = false,
          .is_actuator = false};
}

ComponentType orifice_type() {
  return {.name = "orifice",
          .fields = kOrificeFields,
          .doc = "sharp-edged orifice",
          .make_def = []() -> std::unique_ptr<ComponentDef> { return std::make_unique<OrificeDef>(); },
          .has_control_signal = false,
          .has_ls_port = false,
          .is_actuator = false};
}

ComponentType laminar_restriction_type() {
  return {.name = "laminar_restriction",
          .fields = kLaminarRestrictionFields,
          .doc = "thin pipe with laminar flow",
          .make_def = []() -> std::unique_ptr<ComponentDef> { return std::make_unique<LaminarRestrictionDef>(); },
          .has_control_signal = false,
          .has_ls_port = false,
          .is_actuator = false};
}

}  // namespace slew::hydraulics
