// SPDX-License-Identifier: Apache-2.0
// Sensors of a scene with the shapes and bodies that they look at.
#pragma once

#include <string>
#include <vector>

#include "core/problem.h"
#include "scene/scene.h"
#include "sensors/sensors.h"

namespace slew::scene {

// The sensors, the shapes that they name, and these shapes' frames: Ground first, then the bodies in the order of
// PoseSample, also those that are fixed to Ground. Pre-condition: the scene's meshes were read.
[[nodiscard]] sensors::SensorsDef sensors_of(const Scene& scene);

// Reports sensors that cannot work, and limits of a session's messages. Pre-condition: all names are resolved.
void check_sensors(const Scene& scene, Problems& problems);

}  // namespace slew::scene
