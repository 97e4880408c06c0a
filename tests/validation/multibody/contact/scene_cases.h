// SPDX-License-Identifier: Apache-2.0
// The scenes of the cases of section D, as the formulation under test moves them.
#pragma once

#include "build_paths.h"
#include "contact_scene.h"
#include "scene/scene.h"

namespace slew::multibody::testing {

inline MechanicsDef contact_scene(const std::string& name) {
  return scene::load_file(std::string(SLEWRING_SOURCE_DIR) + "/scenes/contact/" + name + ".yaml").mechanics;
}

class EveryWay : public ::testing::TestWithParam<Way> {};

}  // namespace slew::multibody::testing
