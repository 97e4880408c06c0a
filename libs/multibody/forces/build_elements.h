// From the Defs of elements and dummies to the model's arrays. Internal to the library.
#pragma once

#include <span>

#include "multibody/model/model.h"
#include "multibody/model/topology.h"

namespace slew::multibody {

// Appends elements and lumped masses to a model whose bodies are placed. poses: of all bodies at the start.
void add_elements(const MechanicsDef& def, std::span<const Pose> poses, Model& model);

}  // namespace slew::multibody
