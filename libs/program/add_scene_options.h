// SPDX-License-Identifier: Apache-2.0
// Options of the command line for the scene of a session and its changes.
#pragma once

#include <string>

#include "options/options.h"
#include "scene/scene_options.h"

namespace slew::program {

// An option or argument whose value is a scene file, looked up by scene::find_scene().
options::Option add_scene_file(options::Command& app, const std::string& name, std::string& file,
                               const std::string& description = "scene file");

// SCENE or --from FILE and --assets, --set, --step, --duration, --pace, --input, --record, --no-record,
// --record-steps.
void add_scene_options(options::Command& app, scene::SceneOptions& options);

}  // namespace slew::program
