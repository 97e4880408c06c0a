// SPDX-License-Identifier: Apache-2.0
// Names of the variables of a prescribed motion. Internal to the library.
#pragma once

#include <vector>

#include "core/element_variable.h"
#include "multibody/model/model.h"

namespace slew::multibody {

// "Motion.position", "Motion.velocity", "Motion.acceleration": values of the law.
void list_drives(const Model& model, std::vector<ElementVariable>& variables);

// "Motion.torque" or "Motion.force", "Motion.power".
void list_drive_forces(const Model& model, std::vector<ElementVariable>& variables);

}  // namespace slew::multibody
