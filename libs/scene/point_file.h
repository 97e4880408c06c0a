// The points of a table field in a CSV file of two columns:
//
//   deflection [mm], force [kN]
//   -100, -1.2
//   0, 0
// A column's unit stands in brackets behind its name; without it the numbers are SI. The header is required.
#pragma once

#include <optional>

#include "core/field.h"
#include "scene/diagnostic.h"
#include "scene/source.h"
#include "scene/units.h"

namespace slew::scene {

// Empty after a complaint, which goes to the report. field: of type table.
[[nodiscard]] std::optional<Table> read_point_file(const SourceText& source, const Field& field, UnitSystem& units,
                                                   Report& report);

}  // namespace slew::scene
