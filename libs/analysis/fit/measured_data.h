// SPDX-License-Identifier: Apache-2.0
// Measured signals over time from a CSV file: a column `time [s]` and columns with names and units.
#pragma once

#include <string>
#include <vector>

#include "core/dimension.h"
#include "scene/units.h"

namespace slew::analysis {

struct MeasuredSignal {
  std::string name;
  bool has_unit = false;        // false: its numbers are taken as SI
  scene::Exponents exponent{};  // of its unit
  std::vector<double> time;     // s, ascending
  std::vector<double> value;    // SI; as many as times
};

// The columns with these names; empty cells are left out. Throws LoadError with file:line:col for what is wrong, an
// unknown column included.
[[nodiscard]] std::vector<MeasuredSignal> read_measured(const std::string& file, const std::vector<std::string>& names);

}  // namespace slew::analysis
