// SPDX-License-Identifier: Apache-2.0
// Files of recorded events and frames that devices play: a relative `path` begins at the folder of the scene.
//
// A session publishes names alone; each machine has a folder of its own.
#pragma once

#include <string>

#include "core/problem.h"
#include "scene/devices.h"

namespace slew::scene {

// True if the path is below /dev, where a device may be plugged in later.
[[nodiscard]] bool is_device_file(const std::string& path);
// Puts the folder before the names of recorded files.
void place_recorded_files(DevicesDef& devices, const std::string& folder);
// A problem for every recorded file that is not there.
void check_recorded_files(const DevicesDef& devices, const std::string& folder, Problems& problems);

}  // namespace slew::scene
