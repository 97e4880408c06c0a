// SPDX-License-Identifier: Apache-2.0
// Reads a URDF file: strict for numbers and names, with a note on everything omitted.
#pragma once

#include <optional>
#include <string>

#include "scene/diagnostic.h"
#include "scene/source.h"
#include "urdf/robot.h"

namespace slew::urdf {

// Problems go to the report with their line: malformed XML, unexpanded xacro, missing, duplicate or unknown names,
// invalid numbers, unknown joint types, links that form no tree. The result is then empty.
[[nodiscard]] std::optional<Robot> read_robot(const scene::SourceText& source, scene::Report& report);

}  // namespace slew::urdf
