#include "hydraulics/components/ls_shuttle.h"

namespace slew::hydraulics {
namespace {

constexpr Field kLsShuttleFields[] = {
    field<&LsShuttleDef::port_1>("port_1", {.presence = Presence::required,
                                            .reference = "component",
                                            .doc = "valve or shuttle with a load-sensing pressure"}),
    field<&LsShuttleDef::port_2>("port_2", {.presence = Presence::required,
                                            .reference = "component",
                                            .doc = "valve or shuttle with a load-sensing pressure"}),
    field<&LsShuttleDef::line_time_constant>("line_time_constant",
                                             {.dimension = Dimension::time,
                                              .range = kNotNegative,
                                              .doc = "time constant of the LS line behind the shuttle; 0: none"}),
};

}  // namespace

ComponentType ls_shuttle_type() {
  return {.name = "ls_shuttle",
          .fields = kLsShuttleFields,
          .doc = "higher of two load-sensing pressures",
          .make_def = []() -> std::unique_ptr<ComponentDef> { return std::make_unique<LsShuttleDef>(); },
          .has_control_signal = false,
          .has_ls_port = true,
          .is_actuator = false};
}

}  // namespace slew::hydraulics
