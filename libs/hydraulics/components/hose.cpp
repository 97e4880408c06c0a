#include "hydraulics/components/hose.h"

namespace slew::hydraulics {
namespace {

constexpr Field kHoseFields[] = {
    field<&HoseDef::volume>("volume",
                            {.presence = Presence::required, .reference = "volume", .doc = "connected volume"}),
    field<&HoseDef::length>(
        "length",
        {.dimension = Dimension::length, .range = kPositive, .presence = Presence::required, .doc = "length"}),
    field<&HoseDef::diameter>(
        "diameter",
        {.dimension = Dimension::length, .range = kPositive, .presence = Presence::required, .doc = "inner diameter"}),
    field<&HoseDef::bulk_modulus>("bulk_modulus",
                                  {.dimension = Dimension::pressure,
                                   .range = kPositive,
                                   .doc = "modulus B_e of the wall's law min(B_max, max(B_e sqrt(p), B_min))"}),
    field<&HoseDef::minimum_bulk_modulus>(
        "minimum_bulk_modulus",
        {.dimension = Dimension::pressure, .range = kPositive, .doc = "lower bound of the wall's law"}),
    field<&HoseDef::maximum_bulk_modulus>(
        "maximum_bulk_modulus",
        {.dimension = Dimension::pressure, .range = kPositive, .doc = "upper bound of the wall's law"}),
};

}  // namespace

ComponentType hose_type() {
  return {.name = "hose",
          .fields = kHoseFields,
          .doc = "hose or pipe: oil volume with an elastic wall",
          .make_def = []() -> std::unique_ptr<ComponentDef> { return std::make_unique<HoseDef>(); },
          .has_control_signal = false,
          .has_ls_port = false,
          .is_actuator = false};
}

}  // namespace slew::hydraulics
