// SPDX-License-Identifier: Apache-2.0
// One axis of a stick: raw counts to -1 .. 1.
//
//   x = (raw - centre)/(highest - centre) above the centre, (raw - centre)/(centre - lowest) below it,
//       held at -1 and 1
//   y = sign(x) (|x| - d)/(1 - d) beyond the dead zone d, else 0: no jump at its edge, full stick stays 1
//   z = (1 - e) y + e y^3, the curve with expo e; -z with invert
//
// A pedal has its centre at an end: 0 .. 1, or -1 .. 0. Card: docs/models/devices_axes.md.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "core/field.h"
#include "core/problem.h"

namespace slew::devices {

struct AxisDef {
  std::string code{};        // "ABS_X"
  std::int64_t channel = 0;  // of the inputs' block
  std::int64_t lowest = 0;   // counts
  std::int64_t centre = 0;   // counts, lowest <= centre <= highest
  std::int64_t highest = 0;  // counts, > lowest
  double dead_zone = 0;      // share of half the travel
  double expo = 0;           // 0: straight, 1: cubic
  bool invert = false;
};

[[nodiscard]] std::span<const Field> axis_fields() noexcept;
void validate(std::string_view path, const AxisDef& def, Problems& problems);

struct ShapedAxis {
  double value = 0;
  bool was_held = false;  // raw was outside of lowest .. highest
};

// Pre-condition: the definition has no problem.
[[nodiscard]] ShapedAxis shape(const AxisDef& def, std::int32_t raw) noexcept;

}  // namespace slew::devices
