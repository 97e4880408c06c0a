// SPDX-License-Identifier: Apache-2.0
#include "devices/stick_axis.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/suggestion.h"
#include "devices/field_rules.h"
#include "devices/input_events.h"

namespace slew::devices {
namespace {

constexpr Range kCounts = {.min = std::numeric_limits<std::int32_t>::min(),
                           .max = std::numeric_limits<std::int32_t>::max(),
                           .min_is_open = false,
                           .max_is_open = false};

constexpr Field kAxisFields[] = {
    field<&AxisDef::code>("code", {.presence = Presence::required, .doc = "the kernel's name of the axis, as ABS_X"}),
    field<&AxisDef::channel>("channel", {.range = {.min = 0, .max = 63, .min_is_open = false, .max_is_open = false},
                                         .doc = "channel of the inputs that the axis moves"}),
    field<&AxisDef::lowest>("lowest", {.range = kCounts, .presence = Presence::required, .doc = "counts at one end"}),
    field<&AxisDef::centre>(
        "centre",
        {.range = kCounts, .presence = Presence::required, .doc = "counts at rest, which for a pedal is an end"}),
    field<&AxisDef::highest>("highest",
                             {.range = kCounts, .presence = Presence::required, .doc = "counts at the other end"}),
    field<&AxisDef::dead_zone>(
        "dead_zone", {.range = {.min = 0, .max = 1, .min_is_open = false},
                      .doc = "share of half the travel about the centre that gives 0; the rest is stretched"}),
    field<&AxisDef::expo>("expo", {.range = kFraction, .doc = "curve (1 - e) y + e y^3: finer about the centre"}),
    field<&AxisDef::invert>("invert", {.doc = "reverses the direction"}),
};

}  // namespace

std::span<const Field> axis_fields() noexcept {
  return kAxisFields;
}

void validate(std::string_view path, const AxisDef& def, Problems& problems) {
  check_fields(path, &def, kAxisFields, problems);
  if (!axis_code(def.code)) {
    problems.push_back({fmt::format("{}.code", path), fmt::format("there is no axis '{}'", def.code),
                        "a name of the kernel, as ABS_X", closest(def.code, axis_names())});
  }
  if (!(def.lowest < def.highest && def.lowest <= def.centre && def.centre <= def.highest)) {
    problems.push_back({fmt::format("{}.centre", path),
                        fmt::format("{}, {}, {} are not in order", def.lowest, def.centre, def.highest),
                        "lowest <= centre <= highest, lowest < highest; calibrate the device", ""});
  }
}

ShapedAxis shape(const AxisDef& def, std::int32_t raw) noexcept {
  const bool was_held = raw < def.lowest || raw > def.highest;
  const std::int64_t counts = std::clamp<std::int64_t>(raw, def.lowest, def.highest) - def.centre;
  const std::int64_t side = counts > 0 ? def.highest - def.centre : def.centre - def.lowest;
  const double x = counts == 0 ? 0 : static_cast<double>(counts) / static_cast<double>(side);
  const double beyond = (std::abs(x) - def.dead_zone) / (1 - def.dead_zone);
  const double y = beyond > 0 ? std::copysign(beyond, x) : 0;
  const double z = (1 - def.expo) * y + def.expo * y * y * y;
  return {def.invert ? 0 - z : z, was_held};
}

}  // namespace slew::devices
