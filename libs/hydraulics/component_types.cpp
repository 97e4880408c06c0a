// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "hydraulics/component_def.h"
#include "hydraulics/components/accumulator.h"
#include "hydraulics/components/check_valves.h"
#include "hydraulics/components/compensated_orifice.h"
#include "hydraulics/components/cooler.h"
#include "hydraulics/components/counterbalance_valve.h"
#include "hydraulics/components/direct_relief_valve.h"
#include "hydraulics/components/double_acting_cylinder.h"
#include "hydraulics/components/double_rod_cylinder.h"
#include "hydraulics/components/engine.h"
#include "hydraulics/components/filter.h"
#include "hydraulics/components/flow_divider.h"
#include "hydraulics/components/flushing_valve.h"
#include "hydraulics/components/four_way_valve.h"
#include "hydraulics/components/heat_loss.h"
#include "hydraulics/components/hose.h"
#include "hydraulics/components/hose_burst_valve.h"
#include "hydraulics/components/hydraulic_motor.h"
#include "hydraulics/components/l90ls_valve.h"
#include "hydraulics/components/line.h"
#include "hydraulics/components/ls_pump.h"
#include "hydraulics/components/ls_shuttle.h"
#include "hydraulics/components/post_compensator.h"
#include "hydraulics/components/priority_valve.h"
#include "hydraulics/components/pump.h"
#include "hydraulics/components/reducing_valve.h"
#include "hydraulics/components/relief_valve.h"
#include "hydraulics/components/restrictions.h"
#include "hydraulics/components/shuttle_valve.h"
#include "hydraulics/components/single_acting_cylinder.h"
#include "hydraulics/components/slew_cylinder.h"
#include "hydraulics/components/sources.h"
#include "hydraulics/components/spool_valve.h"
#include "hydraulics/components/telescopic_cylinder.h"
#include "hydraulics/components/unloading_valve.h"

namespace slew::hydraulics {

std::span<const ComponentType> component_types() {
  static const std::array types = {
      hose_type(),
      line_type(),
      double_acting_cylinder_type(),
      double_rod_cylinder_type(),
      single_acting_cylinder_type(),
      telescopic_cylinder_type(),
      slew_cylinder_type(),
      hydraulic_motor_type(),
      l90ls_valve_type(),
      four_way_valve_type(),
      spool_valve_type(),
      ls_shuttle_type(),
      relief_valve_type(),
      direct_relief_valve_type(),
      reducing_valve_type(),
      check_valve_type(),
      throttle_check_valve_type(),
      pilot_check_valve_type(),
      double_pilot_check_valve_type(),
      counterbalance_valve_type(),
      hose_burst_valve_type(),
      accumulator_type(),
      compensated_orifice_type(),
      post_compensator_type(),
      priority_valve_type(),
      flow_divider_type(),
      gear_flow_divider_type(),
      shuttle_valve_type(),
      flushing_valve_type(),
      unloading_valve_type(),
      ls_pump_type(),
      pump_type(),
      engine_type(),
      flow_source_type(),
      pressure_source_type(),
      bleed_type(),
      orifice_type(),
      laminar_restriction_type(),
      filter_type(),
      cooler_type(),
      heat_loss_type(),
  };
  return types;
}

std::vector<std::string_view> volumes_of(const ComponentDef& def) {
  std::vector<std::string_view> names;
  const ComponentType* const type = find_component_type(def.type_name());
  if (type == nullptr) return names;
  for (const Field& row : type->fields) {
    if (row.reference != "volume" || row.type != FieldType::text) continue;
    // the table binds members of a Def that may change; nothing is changed here
    const std::string& name = *static_cast<const std::string*>(row.member(const_cast<ComponentDef&>(def).address()));
    if (!name.empty()) names.emplace_back(name);
  }
  return names;
}

bool ComponentDef::takes_signal() const {
  const ComponentType* type = find_component_type(type_name());
  return type != nullptr && type->has_control_signal;
}

const ComponentType* find_component_type(std::string_view name) {
  for (const ComponentType& type : component_types()) {
    if (type.name == name) return &type;
  }
  return nullptr;
}

const Field* find_field(const ComponentDef& def, std::string_view key) {
  const ComponentType* type = find_component_type(def.type_name());
  if (type == nullptr) return nullptr;
  for (const Field& field : type->fields) {
    if (field.key == key) return &field;
  }
  return nullptr;
}

}  // namespace slew::hydraulics
