// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/pump_lines.h"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "hydraulics/oil.h"

namespace slew::hydraulics {
namespace {

constexpr double kBar = 1e5;

using Volumes = std::set<std::string>;

// Volumes whose pressure follows the pump's: a pilot needs no flow. A held volume passes no pressure on.
Volumes pressurised(const PumpLines& lines, const PumpLines::Pump& pump) {
  Volumes line = {pump.outlet};
  const auto reach = [&](const std::string& from, const std::string& to) {
    return line.contains(from) && !lines.held.contains(to) && line.insert(to).second;
  };
  for (bool grows = true; grows;) {
    grows = false;
    for (const PumpLines::Connection& way : lines.open) {
      if (!(way.flow > 0) || (!way.pilot.empty() && !line.contains(way.pilot))) continue;
      grows |= reach(way.a, way.b) || (!way.is_one_way && reach(way.b, way.a));
    }
    for (const PumpLines::Divider& divider : lines.dividers) {
      grows |= reach(divider.common, divider.branch_2) || reach(divider.common, divider.branch_3);
    }
  }
  return line;
}

// by what passes the pump's flow: volumes from which it gets away, from those that take it back to those before them
bool is_relieved(const PumpLines& lines, const PumpLines::Pump& pump) {
  const Volumes pilots = pressurised(lines, pump);
  Volumes relieved = lines.held;
  relieved.insert(pump.inlet);
  const auto leads = [&](const std::string& from, bool is_open) { return is_open && relieved.insert(from).second; };
  for (bool grows = true; grows;) {
    grows = false;
    for (const PumpLines::Connection& way : lines.open) {
      if (!(way.flow > 0) || way.flow < pump.flow || (!way.pilot.empty() && !pilots.contains(way.pilot))) continue;
      grows |= leads(way.a, relieved.contains(way.b));
      grows |= leads(way.b, !way.is_one_way && relieved.contains(way.a));
    }
    for (const PumpLines::Divider& divider : lines.dividers) {
      grows |= leads(divider.common, relieved.contains(divider.branch_2) && relieved.contains(divider.branch_3));
    }
  }
  return relieved.contains(pump.outlet);
}

}  // namespace

PumpLines lines_of(const HydraulicsDef& def) {
  PumpLines lines{.oil_density = def.oil_density};
  for (const VolumeDef& volume : def.volumes) {
    if (volume.fixed) lines.held.insert(volume.name);
  }
  for (const auto& component : def.components) component->add_lines(lines);
  return lines;
}

void find_unrelieved_pumps(const HydraulicsDef& def, Problems& warnings) {
  const PumpLines lines = lines_of(def);
  for (const PumpLines::Pump& pump : lines.pumps) {
    if (is_relieved(lines, pump)) continue;
    const std::string end = std::isfinite(pump.pressure)
                                ? fmt::format("ends where the pump's controller does, {:.6g} bar above tank, or beyond",
                                              pump.pressure / kBar)
                                : std::string("rises without limit");
    warnings.push_back(
        {pump.name + "." + pump.key,
         fmt::format("no relief valve leads from the pump's line to a tank: where '{}' is closed off, its pressure {}",
                     pump.outlet, end),
         fmt::format("a relief_valve from the line to a tank, set below {:g} bar", OilCompressibility::kHighest / kBar),
         ""});
  }
}

std::vector<std::pair<std::string, std::string>> open_passages(const PumpLines& lines) {
  std::vector<std::pair<std::string, std::string>> passages = lines.open_at_rest;
  for (const PumpLines::Connection& way : lines.open) {
    if (!way.is_one_way && way.pilot.empty() && way.flow > 0) passages.emplace_back(way.a, way.b);
  }
  for (const PumpLines::Divider& divider : lines.dividers) {
    passages.emplace_back(divider.common, divider.branch_2);
    passages.emplace_back(divider.common, divider.branch_3);
  }
  return passages;
}

std::vector<int> joined_by_passages(const HydraulicsDef& def) {
  std::map<std::string, std::size_t> index;
  std::vector<int> group;
  for (std::size_t i = 0; i < def.volumes.size(); ++i) {
    index.emplace(def.volumes[i].name, i);
    group.push_back(def.volumes[i].fixed ? -1 : static_cast<int>(i));
  }
  for (const auto& [a, b] : open_passages(lines_of(def))) {
    const int kept = group[index.at(a)], other = group[index.at(b)];
    if (kept < 0 || other < 0) continue;
    for (int& of_volume : group) {
      if (of_volume == other) of_volume = kept;
    }
  }
  return group;
}

}  // namespace slew::hydraulics
