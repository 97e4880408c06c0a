// Reads a URDF file: strictly where a number or a name matters, with a note on everything that is left out.
#pragma once

#include <optional>
#include <string>

#include "scene/diagnostic.h"
#include "scene/source.h"
#include "urdf/robot.h"

namespace slew::urdf {

// Problems go to the report with their line: XML that is not well formed, what xacro has not expanded, names that are
// missing, doubled or unknown, numbers that are none, unknown joint types, what is no tree.
// Nothing is returned then.
[[nodiscard]] std::optional<Robot> read_robot(const scene::SourceText& source, scene::Report& report);

}  // namespace slew::urdf
