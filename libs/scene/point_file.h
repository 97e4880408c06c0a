// SPDX-License-Identifier: Apache-2.0
// The points of a table field in a CSV file:
//
//   deflection [mm], force [kN]
//   -100, -1.2
//   0, 0
// A column's unit stands in brackets behind its name; without it the numbers are SI. The header is required. In a file
// with more than two columns, argument and value are selected by name. csv_cells.h describes such files.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/field.h"
#include "scene/diagnostic.h"
#include "scene/source.h"
#include "scene/units.h"

namespace slew::scene {

// Empty after a reported problem, which goes to the report. field: of type table; columns: names of argument and value,
// or empty for a file of two columns.
[[nodiscard]] std::optional<Table> read_point_file(const SourceText& source, const std::vector<std::string>& columns,
                                                   const Field& field, UnitSystem& units, Report& report);

}  // namespace slew::scene
