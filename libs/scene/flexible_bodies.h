// The files of flexible bodies: read, checked, and counted among the scene's assets.
#pragma once

#include "core/problem.h"
#include "scene/expand.h"
#include "scene/scene.h"

namespace slew::scene {

// Reads Model_Prefix_Matrix.dat (flex/flexible_files.h) of every flexible body into scene.mechanics.flexible_bodies,
// with the modes that the body takes, and of every segmented one into segmented_bodies, cut into segments; adds the
// files to scene.assets. Without files that may be read the bodies keep no modes. Bodies of one set share it. Problems
// have the path of the key that is at fault. Warned about: mass and centre of mass that the scene gives the body
// besides, and that are not those of the files within a percent. Allocates, reads files.
void read_flexible_bodies(const Surroundings& surroundings, Scene& scene, Problems& problems, Problems& warnings);

}  // namespace slew::scene
