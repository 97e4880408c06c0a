// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/pump_lines.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "hydraulics/oil.h"

namespace slew::hydraulics {
namespace {

constexpr double kBar = 1e5;

PumpLines lines_of(const HydraulicsDef& def) {
  PumpLines lines{.oil_density = def.oil_density};
  for (const VolumeDef& volume : def.volumes) {
    if (volume.fixed) lines.relieved.insert(volume.name);
  }
  for (const auto& component : def.components) component->add_lines(lines);
  return lines;
}

// by what passes the pump's flow
bool is_relieved(const PumpLines& lines, const PumpLines::Pump& pump) {
  std::set<std::string> line = {pump.outlet};
  std::vector<std::string> unvisited = {pump.outlet};
  while (!unvisited.empty()) {
    const std::string volume = std::move(unvisited.back());
    unvisited.pop_back();
    if (lines.relieved.contains(volume)) return true;
    for (const PumpLines::Connection& way : lines.open) {
      const std::string* const next = way.a == volume ? &way.b : way.b == volume && !way.is_one_way ? &way.a : nullptr;
      if (way.flow < pump.flow) continue;
      if (next != nullptr && line.insert(*next).second) unvisited.push_back(*next);
    }
  }
  return false;
}

}  // namespace

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
         fmt::format("the pump's line has no relief valve: where '{}' is closed off, its pressure {}", pump.outlet,
                     end),
         fmt::format("a relief_valve on the line, set below {:g} bar", OilCompressibility::kHighest / kBar), ""});
  }
}

}  // namespace slew::hydraulics
