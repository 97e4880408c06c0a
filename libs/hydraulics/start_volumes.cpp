// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/start_volumes.h"

#include <fmt/format.h>

#include <map>
#include <string>
#include <utility>

#include "hydraulics/pump_lines.h"

namespace slew::hydraulics {
namespace {

constexpr double kPascalsPerBar = 1e5;

// Volume, and the actuator whose force sets its pressure.
std::map<std::string, std::string> volumes_of_actuators(const HydraulicsDef& def) {
  std::map<std::string, std::string> found;
  for (const auto& component : def.components) {
    if (const auto actuator = component->actuator()) {
      found.emplace(actuator->port_a, component->name);
      found.emplace(actuator->port_b, component->name);
    }
  }
  return found;
}

}  // namespace

std::vector<int> joined_to_actuators(const HydraulicsDef& def) {
  constexpr int kNone = -1, kUnsettled = -2;
  const PumpLines lines = lines_of(def);
  std::map<std::string, std::size_t> index;
  for (std::size_t i = 0; i < def.volumes.size(); ++i) index.emplace(def.volumes[i].name, i);
  std::vector<int> nearest(def.volumes.size(), kNone);
  for (const auto& [volume, actuator] : volumes_of_actuators(def))
    nearest[index.at(volume)] = static_cast<int>(index.at(volume));
  for (const std::string& volume : lines.held) nearest[index.at(volume)] = kUnsettled;
  for (const std::string& volume : lines.supply) nearest[index.at(volume)] = kUnsettled;
  const auto passages = open_passages(lines);
  // first what has no rest, over all that it joins, then each actuator's pressure, passage by passage
  for (bool grows = true; grows;) {
    grows = false;
    for (const auto& [a, b] : passages) {
      int& one = nearest[index.at(a)];
      int& other = nearest[index.at(b)];
      if ((one == kUnsettled) == (other == kUnsettled)) continue;
      one = other = kUnsettled;
      grows = true;
    }
  }
  for (bool grows = true; grows;) {
    grows = false;
    const std::vector<int> before = nearest;
    for (const auto& [a, b] : passages) {
      for (const auto& [from, to] : {std::pair(index.at(a), index.at(b)), std::pair(index.at(b), index.at(a))}) {
        if (before[from] < 0 || nearest[to] != kNone) continue;
        nearest[to] = before[from];
        grows = true;
      }
    }
  }
  for (std::size_t i = 0; i < nearest.size(); ++i) {
    const bool is_stated = def.volumes[i].initial_pressure != VolumeDef{}.initial_pressure;
    if (nearest[i] == static_cast<int>(i) || is_stated || nearest[i] < 0) nearest[i] = kNone;
  }
  return nearest;
}

void find_replaced_pressures(const HydraulicsDef& def, Problems& warnings) {
  if (def.start != StartState::equilibrium) return;
  const std::map<std::string, std::string> actuators = volumes_of_actuators(def);
  const PumpLines lines = lines_of(def);
  for (const VolumeDef& volume : def.volumes) {
    if (volume.fixed || volume.initial_pressure == VolumeDef{}.initial_pressure) continue;
    const auto held = actuators.find(volume.name);
    const bool is_supply = lines.supply.contains(volume.name) && volume.initial_pressure != def.start_pump_pressure;
    if (held == actuators.end() && !is_supply) continue;
    const std::string taken =
        held != actuators.end()
            ? fmt::format("the pressure by which '{}' holds its load", held->second)
            : fmt::format("hydraulics.start_pump_pressure, {:.6g} bar", def.start_pump_pressure / kPascalsPerBar);
    warnings.push_back({volume.name + ".initial_pressure",
                        fmt::format("an equilibrium start does not read it: the volume begins at {}", taken),
                        held != actuators.end() ? "no such key, or hydraulics.start: table13"
                                                : "that pressure there, or hydraulics.start: table13",
                        ""});
  }
}

}  // namespace slew::hydraulics
