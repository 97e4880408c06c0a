// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/line_limits.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "hydraulics/pump_lines.h"

namespace slew::hydraulics {
namespace {

constexpr double kPascalPerBar = 1e5;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct PressureLimit {
  double pressure = 0;     // Pa absolute
  std::string_view valve;  // that sets it; empty: none
};
using Limits = std::map<std::string_view, PressureLimit>;

// Limit that the components give a volume, without its relief valves.
PressureLimit fed_limit(const HydraulicsDef& def, std::string_view volume, const Limits& limits) {
  PressureLimit highest;
  for (const auto& component : def.components) {
    const std::vector<std::string_view> names = volumes_of(*component);
    if (std::find(names.begin(), names.end(), volume) == names.end()) continue;
    if (component->raises_pressure()) return {kInfinity, {}};
    for (const std::string_view name : names) {
      const PressureLimit& other = limits.at(name);
      if (name != volume && other.pressure > highest.pressure) highest = other;
    }
  }
  return highest;
}

// From below: each round passes the limits on by one component.
Limits limits_of(const HydraulicsDef& def, const PumpLines& lines) {
  Limits limits;
  for (const VolumeDef& volume : def.volumes) {
    limits[volume.name] = {volume.fixed ? volume.initial_pressure : 0, {}};
  }
  for (std::size_t round = 0; round <= def.volumes.size(); ++round) {
    for (const VolumeDef& volume : def.volumes) {
      if (volume.fixed) continue;
      PressureLimit limit = fed_limit(def, volume.name, limits);
      for (const PumpLines::Limit& relief : lines.limits) {
        const double opens = relief.setting + limits.at(relief.outlet).pressure;
        if (relief.volume == volume.name && opens < limit.pressure) limit = {opens, relief.valve};
      }
      limits[volume.name] = limit;
    }
  }
  return limits;
}

// Volumes that components join to a volume, itself among them, up to fixed ones. is_fed: one of them is fed.
struct Group {
  std::set<std::string_view> volumes;
  bool is_fed = false;
};

Group group_of(const HydraulicsDef& def, std::string_view volume, const std::set<std::string_view>& fixed) {
  Group group{.volumes = {volume}};
  for (std::size_t before = 0; before != group.volumes.size();) {
    before = group.volumes.size();
    for (const auto& component : def.components) {
      const std::vector<std::string_view> names = volumes_of(*component);
      const bool is_at = std::any_of(names.begin(), names.end(), [&](std::string_view name) {
        return group.volumes.contains(name) && !fixed.contains(name);
      });
      if (!is_at) continue;
      group.is_fed = group.is_fed || component->raises_pressure();
      group.volumes.insert(names.begin(), names.end());
    }
  }
  return group;
}

}  // namespace

void find_unfilled_accumulators(const HydraulicsDef& def, Problems& warnings) {
  const PumpLines lines = lines_of(def);
  if (lines.accumulators.empty() || lines.limits.empty()) return;
  const Limits limits = limits_of(def, lines);
  for (const PumpLines::Accumulator& accumulator : lines.accumulators) {
    const PressureLimit& limit = limits.at(accumulator.volume);
    if (limit.valve.empty() || accumulator.precharge < limit.pressure) continue;
    warnings.push_back(
        {accumulator.name + ".precharge_pressure",
         fmt::format("the accumulator never fills: its precharge of {:.6g} bar is not below the {:.6g} bar at which "
                     "'{}' opens (both absolute)",
                     accumulator.precharge / kPascalPerBar, limit.pressure / kPascalPerBar, limit.valve),
         "a lower precharge_pressure, or a higher setting of the relief valve", ""});
  }
}

void find_idle_volumes(const HydraulicsDef& def, Problems& warnings) {
  // oil that warms up and cools down does something
  if (def.oil_temperature != OilTemperature::one) return;
  std::map<std::string_view, const VolumeDef*> by_name;
  std::set<std::string_view> fixed;
  for (const VolumeDef& volume : def.volumes) {
    by_name[volume.name] = &volume;
    if (volume.fixed) fixed.insert(volume.name);
  }
  for (const auto& component : def.components) {
    if (component->type_name() != "hose") continue;
    const std::string volume = member_of<std::string>(*component, "volume");
    if (!by_name.at(volume)->fixed) continue;
    warnings.push_back(
        {component->name + ".volume",
         fmt::format("the hose does nothing: the pressure of '{}' is fixed, whatever it contains", volume),
         "a volume that is not fixed, or no hose", ""});
  }
  for (const VolumeDef& volume : def.volumes) {
    if (volume.fixed) continue;
    const Group group = group_of(def, volume.name, fixed);
    const bool is_level = std::all_of(group.volumes.begin(), group.volumes.end(), [&](std::string_view name) {
      return by_name.at(name)->initial_pressure == volume.initial_pressure;
    });
    if (group.is_fed || !is_level) continue;
    const std::string beside = group.volumes.size() == 1 ? std::string("no component leads to another one")
                                                         : fmt::format("all that is joined to it begins at {:.6g} bar",
                                                                       volume.initial_pressure / kPascalPerBar);
    warnings.push_back({volume.name,
                        "its oil does not move: no pump, source or cylinder is joined to the volume, and " + beside,
                        "a component that feeds it, another initial_pressure, or no such volume", ""});
  }
}

}  // namespace slew::hydraulics
