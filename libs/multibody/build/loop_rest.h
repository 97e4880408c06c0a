// SPDX-License-Identifier: Apache-2.0
// Modal coordinates at the start in mechanisms with loops. Internal to the library.
#pragma once

#include "multibody/build/assembly.h"

namespace slew::multibody {

// Moves the start of a mechanism with loops, closed by assemble(), to the static equilibrium of its flexible bodies
// without a given start (equilibrium.h): the actuators (MechanicsDef::held_forces) hold the lengths and angles of the
// start, joints that neither they nor loops move stay (loads on balls keep their attitudes), and the others follow the
// bodies that bend, loops closed. The forces of the actuators are those that hold the machine, at the nodes where they
// act. Speeds that the scene gives are projected again. Without a change where the actuators and loops leave a joint
// free, or where no equilibrium is stable; with one, Model::rests_in_loops is true.
void rest_in_loops(const MechanicsDef& def, Model& model, AssemblyReport& report);

}  // namespace slew::multibody
