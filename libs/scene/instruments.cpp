// SPDX-License-Identifier: Apache-2.0
#include "scene/instruments.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string_view>

#include "scene/sections.h"

namespace slew::scene {
namespace {

constexpr std::string_view kMeasuredMechanics[] = {"bodies",   "joints",    "forces",  "dummies",
                                                   "contacts", "frictions", "motions", "gears"};
constexpr std::string_view kMeasuredHydraulics[] = {"volumes", "components"};

bool is_among(std::span<const std::string_view> names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

// Node that computes the element of the instrument; none: no node that steps with the machine.
std::optional<Computes> node_of(const std::vector<ElementRef>& all, const measurement::InstrumentDef& def) {
  const std::string_view element = def.variable.empty()
                                       ? std::string_view(def.body)
                                       : std::string_view(def.variable).substr(0, def.variable.find('.'));
  for (const ElementRef& one : all) {
    if (one.name != element) continue;
    if (is_among(kMeasuredMechanics, one.section)) return Computes::mechanics;
    if (is_among(kMeasuredHydraulics, one.section)) return Computes::hydraulics;
  }
  return std::nullopt;
}

// the tables bind to mutable Defs; they are only read here
std::vector<ElementRef> elements_of(const Scene& scene) {
  return elements(const_cast<Scene&>(scene));
}

}  // namespace

std::vector<measurement::InstrumentDef> instruments_of(const Scene& scene, Computes node) {
  std::vector<measurement::InstrumentDef> own;
  if (scene.instruments.empty()) return own;
  const std::vector<ElementRef> all = elements_of(scene);
  for (const measurement::InstrumentDef& def : scene.instruments) {
    if (node_of(all, def) == node) own.push_back(def);
  }
  return own;
}

void check_instruments(const Scene& scene, Problems& problems) {
  if (scene.instruments.empty()) return;
  measurement::validate(scene.instruments, scene.session.step_duration(), problems);
  const std::vector<ElementRef> all = elements_of(scene);
  const bool has_temperatures = scene.hydraulics.oil_temperature == hydraulics::OilTemperature::by_volume;
  for (const measurement::InstrumentDef& def : scene.instruments) {
    if (def.type == measurement::InstrumentType::temperature && !has_temperatures) {
      problems.push_back({def.name + ".variable", "the oil has one temperature, which no variable shows",
                          "hydraulics.oil_temperature: by_volume", ""});
      continue;
    }
    if (node_of(all, def)) continue;
    const bool is_imu = def.type == measurement::InstrumentType::imu;
    problems.push_back(
        {def.name + (is_imu ? ".body" : ".variable"),
         fmt::format("'{}' is no quantity of the mechanics or the hydraulics", is_imu ? def.body : def.variable),
         "a variable of a body, joint, force, volume or component; `slewring variables SCENE` lists them", ""});
  }
}

}  // namespace slew::scene
