// SPDX-License-Identifier: Apache-2.0
// The files of flexible bodies: read, checked, and counted among the scene's assets.
#pragma once

#include "core/problem.h"
#include "scene/expand.h"
#include "scene/scene.h"

namespace slew::scene {

// Reads Model_Prefix_Matrix.dat (flex/flexible_files.h) of every flexible body into scene.mechanics.flexible_bodies,
// with the selected modes, and of every segmented one into segmented_bodies, divided into segments; adds the files to
// scene.assets. If files may not be read, the bodies keep no modes. Bodies of one set share it. Problems have the path
// of the faulty key. Warns about a mass or centre of mass in the scene that differs from the files by more than a
// percent. Allocates, reads files.
void read_flexible_bodies(const LoadContext& load_context, Scene& scene, Problems& problems, Problems& warnings);

}  // namespace slew::scene
